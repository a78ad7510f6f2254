/* What is known of sets of times from other walks.
 *
 * Where maneuvers cost nothing, or different ways lead to the same place, many walks hold the same trims with the same
 * displacements between: sets of times that are one problem. It is told by its numbers, rounded to what makes no
 * difference; only a mark of 128 bits of them is kept.
 */
#include "sets.c"
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#define ALIKE 1e-12       /* of the way and of the largest speed, and rad: what makes no difference */
#define SIMILAR 1e-3      /* likewise: what makes little difference */

typedef struct {
    uint64_t mark[2];
    double coasting, inside;  /* s that the set takes: with all of its times 0 or more, with all of them more than 0 */
    int numbers, unrefuted;   /* place of its numbers; how often a multiplier was sought in vain (alike.c) */
} KnownSet;

typedef struct {
    KnownSet *sets;
    long count, room;
    double way, speed, angle; /* m, m/s, rad: what makes no difference */
    int once;                 /* whether sets are looked at once only, whatever the best is */
} Known;

/* The numbers of a walk from which the marks of its sets of times are made. */
typedef struct {
    uint64_t coast[MOST][2];
    cplx before[MOST];        /* what the maneuvers before have displaced */
    uint64_t end[2];
} Marks;

/* Room for a power of 2 of sets, where scales are such; none where there is no memory. */
static void make_known(Known *known, long room, double share, double way, double speed)
{
    known->once = share > ALIKE;
    known->sets = calloc((size_t)room, sizeof(KnownSet));
    known->room = known->sets ? room : 0;
    known->way = share * (way > 0 ? way : 1);
    known->speed = share * (speed > 0 ? speed : 1);
    known->angle = share;
}

static void mix(uint64_t *mark, uint64_t value)
{
    mark[0] = (mark[0] ^ value) * 0x9E3779B97F4A7C15u;
    mark[0] ^= mark[0] >> 29;
    mark[1] = (mark[1] + value) * 0xD6E8FEB86659FD93u;
    mark[1] ^= mark[1] >> 32;
}

static void mix_number(uint64_t *mark, double value) { mix(mark, (uint64_t)(int64_t)value); }

static void mix_vector(uint64_t *mark, cplx value, double unit)
{
    mix_number(mark, rint(creal(value) / unit));
    mix_number(mark, rint(cimag(value) / unit));
}

static void set_marks(Marks *marks, const Row *row, const Known *known)
{
    cplx before = 0;
    memset(marks->coast, 0, sizeof(marks->coast));
    for (int k = 0; k < row->trims; k++) {
        uint64_t rate;
        memcpy(&rate, &row->rate[k], sizeof(rate));
        marks->before[k] = before += row->D[k];
        mix(marks->coast[k], rate);
        mix_vector(marks->coast[k], row->W[k], known->speed);
    }
    marks->end[0] = marks->end[1] = 1;
    mix_vector(marks->end, before, known->way);
    if (row->wants_heading) mix_number(marks->end, rint(off_turns(row->heading) / known->angle));
}

/* Where a set of times is known, or a free place for it; none where there is no room. */
static KnownSet *place_of(Known *known, const Marks *marks, unsigned mask)
{
    if (!known) return 0;
    uint64_t mark[2] = {marks->end[0], marks->end[1]};
    for (unsigned rest = mask; rest; rest &= rest - 1) {
        int k = __builtin_ctz(rest);
        mix(mark, marks->coast[k][0]);
        mix(mark, marks->coast[k][1]);
        mix_vector(mark, marks->before[k], known->way);
    }
    mark[0] |= 1;
    for (long at = (long)(mark[1] & (uint64_t)(known->room - 1));; at = (at + 1) & (known->room - 1)) {
        KnownSet *set = &known->sets[at];
        if (set->mark[0] == mark[0] && set->mark[1] == mark[1]) return set;
        if (set->mark[0]) continue;
        if (2 * known->count > known->room) return 0;
        memcpy(set->mark, mark, sizeof(mark));
        known->count++;
        return set;
    }
}

static double clock_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int late(double until) { return until < INFINITY && clock_now() >= until; }
