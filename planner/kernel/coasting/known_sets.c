/* Sets of times that many walks share.
 *
 * Where maneuvers cost nothing, or different ways lead to the same place, many walks hold the same trims with the same
 * displacements between: their sets of times are one problem. It is told by its numbers, rounded to what makes no
 * difference; 128 bits mixed from them are kept.
 */
#include "coasting.h"
#include <stdlib.h>

/* Room for a power of 2 of sets whose numbers are rounded to a share of the way, of the speed, and of a radian; none
 * where there is no memory. With once, a set is looked at once only, whatever the best is then. */
KnownSets *make_known_sets(long room, double share, double way, double speed, int once)
{
    KnownSets *known = malloc(sizeof(KnownSets));
    if (!known) return 0;
    *known = (KnownSets){.room = room, .angle = share, .once = once};
    known->way = share * (way > 0 ? way : 1);
    known->speed = share * (speed > 0 ? speed : 1);
    known->sets = calloc((size_t)room, sizeof(KnownSet));
    if (known->sets) return known;
    free(known);
    return 0;
}

void free_known_sets(KnownSets *known)
{
    if (known) free(known->sets);
    free(known);
}

static void mix(uint64_t *mark, uint64_t value)
{
    mark[0] = (mark[0] ^ value) * 0x9E3779B97F4A7C15u;
    mark[0] ^= mark[0] >> 29;
    mark[1] = (mark[1] + value) * 0xD6E8FEB86659FD93u;
    mark[1] ^= mark[1] >> 32;
}

static void mix_number(uint64_t *mark, double value, double unit)
{
    mix(mark, (uint64_t)(int64_t)rint(value / unit));
}

static void mix_vector(uint64_t *mark, cplx value, double unit)
{
    mix_number(mark, creal(value), unit);
    mix_number(mark, cimag(value), unit);
}

/* The marks of a walk from which those of its sets are made. */
void set_marks(Marks *marks, const Problem *p, const KnownSets *known)
{
    cplx before = 0;
    memset(marks->coast, 0, sizeof(marks->coast));
    for (int k = 0; k < p->trims; k++) {
        uint64_t rate;
        memcpy(&rate, &p->rate[k], sizeof(rate));
        marks->before[k] = before += p->D[k];
        mix(marks->coast[k], rate);
        mix_vector(marks->coast[k], p->W[k], known->speed);
    }
    marks->end[0] = marks->end[1] = 1;
    mix_vector(marks->end, before, known->way);
    if (p->wants_heading) mix_number(marks->end, off_turns(p->heading), known->angle);
}

/* Where a set is known, or a free place for it; none where there is no room. */
KnownSet *known_set(KnownSets *known, const Marks *marks, unsigned mask)
{
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
