/* Sets of times that are nearly one problem, in many walks: looked at together.
 *
 * Where maneuvers differ by little, many walks hold the same trims with nearly the same displacements between. If the
 * goal were wider by as much as one of them differs from another, every plan of the one would be a plan of the other.
 * So a look at one set with a wider goal tells what all sets near it take at least.
 *
 * Such a look finds the candidates with all times more than 0. The best plan of a set may have fewer; then it is one of
 * a set with fewer times, whose goal is wider still: by as much as the sets that two looks were at may differ. So what a
 * set takes at least is the least that it, or any set with fewer of its times, was found to take.
 */
#include "coasting.h"
#include <stdlib.h>

#define SIMILAR 1e-3      /* of the way, of the speed, rad: numbers that are told apart */
#define NEAR 1e-3         /* of the way, rad: sets that are near each other differ by half of it at most */
#define ROOM (1 << 19)    /* sets */
#define MOST_NUMBERS (4 << 20) /* kept of sets: 32 MB */
#define AND_MORE 1.02     /* of the seconds that would do */
#define EACH 4            /* sets that are near the first of their like */
#define MUCH 8            /* ... and if they are that much nearer */
#define LEAST 1e-4        /* of the nearness at first: how near they are taken to be at least */

struct AlikeSets {
    KnownSets *sets;
    double *numbers;             /* of the first sets of each like */
    int used;
    double near, aside;          /* m, rad */
    long first, others;          /* sets that were the first of their like, and that were near one */
    double spread[2];            /* m, rad; by which these differed most, twice */
    int learnt;                  /* whether that was looked at */
};

AlikeSets *make_alike_sets(double way, double speed)
{
    AlikeSets *alike = malloc(sizeof(AlikeSets));
    if (!alike) return 0;
    *alike = (AlikeSets){.used = 1, .near = NEAR * (way > 0 ? way : 1), .aside = NEAR};
    alike->sets = make_known_sets(ROOM, SIMILAR, way, speed, 0);
    alike->numbers = malloc(sizeof(double) * MOST_NUMBERS);
    if (alike->sets && alike->numbers) return alike;
    free_alike_sets(alike);
    return 0;
}

void free_alike_sets(AlikeSets *alike)
{
    if (!alike) return;
    free_known_sets(alike->sets);
    free(alike->numbers);
    free(alike);
}

static void put(double *numbers, cplx value)
{
    numbers[0] = creal(value);
    numbers[1] = cimag(value);
}

/* Displacements before the coasts and after the last, velocities, and the heading; returns how many they are. */
static int numbers_of(const Problem *p, const Marks *marks, unsigned mask, double *numbers)
{
    int held = 0, count = __builtin_popcount(mask);
    cplx before = 0;
    for (unsigned rest = mask; rest; rest &= rest - 1, held++) {
        int k = __builtin_ctz(rest);
        put(numbers + 2 * held, marks->before[k] - before);
        put(numbers + 2 * (count + 1 + held), p->W[k]);
        before = marks->before[k];
    }
    put(numbers + 2 * count, marks->before[p->trims - 1] - before);
    numbers[4 * count + 2] = p->wants_heading ? p->heading : 0;
    return 4 * count + 3;
}

/* By how much the same times, with so many seconds in all, lead elsewhere, twice: m, and rad. */
static void set_apart(const double *one, const double *other, int held, double seconds, double *apart)
{
    double way = 0, swing = 0;
    for (int i = 0; i <= 2 * held; i++) {
        double off = hypot(one[2 * i] - other[2 * i], one[2 * i + 1] - other[2 * i + 1]);
        if (i <= held) way += off;
        else swing = greater(swing, off);
    }
    apart[0] = 2 * (way + swing * seconds);
    apart[1] = 2 * fabs(off_turns(one[4 * held + 2] - other[4 * held + 2]));
}

/* Begins anew where all sets are much nearer each other than need be: goals need be less wide then. */
static void learn_nearness(AlikeSets *alike)
{
    if (alike->others < LEARNING || alike->learnt) return;
    alike->learnt = 1;
    if (alike->spread[0] * MUCH > alike->near || alike->spread[1] * MUCH > alike->aside) return;
    alike->near = greater(2 * alike->spread[0], LEAST * alike->near);
    alike->aside = greater(2 * alike->spread[1], LEAST * alike->aside);
    memset(alike->sets->sets, 0, sizeof(KnownSet) * (size_t)alike->sets->room);
    alike->sets->count = 0;
    alike->used = 1;
    alike->first = 0;
}

/* Whether a set is near the first one like it; it may be the first itself. */
static int is_near(AlikeSets *alike, const Problem *p, const Marks *marks, unsigned mask, KnownSet *set)
{
    double numbers[4 * MOST + 3], apart[2];
    int count = numbers_of(p, marks, mask, numbers), first = !set->numbers;
    if (first) {
        if (alike->used + count > MOST_NUMBERS) return 0;
        memcpy(alike->numbers + alike->used, numbers, sizeof(double) * (size_t)count);
        set->numbers = alike->used;
        alike->used += count;
        alike->first++;
        /* Worth a look with a wider goal only where others near it will follow. */
        return alike->others > EACH * alike->first;
    }
    set_apart(numbers, alike->numbers + set->numbers, __builtin_popcount(mask), p->best - p->fixed, apart);
    if (apart[0] > alike->near || apart[1] > alike->aside) return 0;
    alike->others++;
    for (int i = 0; i < 2; i++) alike->spread[i] = greater(alike->spread[i], apart[i]);
    return 1;
}

/* How much wider the goal of a set with so many times is. */
static double wider(int held) { return MOST + 1.5 - held; }

/* Seconds that a set takes at least with all of its times more than 0, with a wider goal; all in units. */
static double look_wider(const Problem *p, unsigned mask, double near, double aside)
{
    Problem wide = *p;
    int held = __builtin_popcount(mask);
    wide.tolerance += wider(held) * near;
    wide.heading_tolerance += wider(held) * aside;
    wide.wants_heading &= wide.heading_tolerance < PI;
    wide.best = wide.fixed + AND_MORE * (wide.best - wide.fixed);
    if (straights_in(&wide, mask) <= 2) {
        ActiveSet on;
        choose(&wide, &on, mask);
        try_both_ways(&wide, &on, mask);
    }
    return greater(wide.best - wide.fixed, 1e-300);
}

/* Whether a wider goal is reached without coasting. */
static int is_there(const Problem *p, const AlikeSets *alike, const Marks *marks)
{
    double away = cabs(marks->before[p->trims - 1] - p->goal) - p->tolerance;
    double aside = fabs(off_turns(p->heading)) - p->heading_tolerance;
    return away <= wider(0) * alike->near && (!p->wants_heading || aside <= wider(0) * alike->aside);
}

/* Marks the sets of times that cannot be faster than the best so far, as those near them cannot; sets: where each is
 * known. */
void exclude_alike(const Problem *p, unsigned useful, const Given *given, KnownSet **sets, char *out)
{
    AlikeSets *alike = given->help->alike;
    learn_nearness(alike);
    Problem si = *given->problem;
    si.best = si.fixed + (p->best - p->fixed) * given->second;
    Marks marks;
    set_marks(&marks, &si, alike->sets);
    double least[1 << MOST], seconds = si.best - si.fixed;
    least[0] = is_there(&si, alike, &marks) ? 0 : INFINITY;
    for (unsigned mask = -useful & useful; mask; mask = (mask - useful) & useful) {
        KnownSet *set = sets[mask] = known_set(alike->sets, &marks, mask);
        least[mask] = out[mask] = 0;
        if (!set || late(given->help->until) || !is_near(alike, &si, &marks, mask, set)) continue;
        if (set->coasting == 0) {
            double others = INFINITY;
            for (unsigned rest = mask; rest; rest &= rest - 1) others = lesser(others, least[mask & ~(rest & -rest)]);
            if (others >= seconds)
                set->coasting = lesser(
                    others, look_wider(p, mask, alike->near / given->metre, alike->aside) * given->second);
        }
        least[mask] = set->coasting;
        out[mask] = least[mask] >= seconds;
    }
}
