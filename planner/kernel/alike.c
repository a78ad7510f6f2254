/* Sets of times that are nearly one problem, in many walks: looked at together.
 *
 * Where maneuvers differ by little, many walks hold the same trims with nearly the same displacements between. If the
 * goal were wider by as much as one of them differs from another, every plan of the one would be a plan of the other.
 * So a look at one set with a wider goal tells what all sets near it take at least.
 *
 * Such a look finds the candidates with all times more than 0. The best plan of a set may have fewer; then it is one of
 * a set with fewer times. The goals of those are wider still, so that they hold for what the larger set leaves of them.
 */
#include "known.c"

#define NEAR 1e-3         /* of the way, and rad: sets that are near each other differ by half of it at most */
#define MOST_NUMBERS (6l << 20) /* kept of sets: 48 MB */
#define AND_MORE 1.02     /* of the seconds that would do */
#define EACH 4            /* sets near each, and more: then even the first is looked at with a wider goal */

typedef struct {
    Known sets;
    double *numbers;          /* of the sets that others are near to */
    int used;
    double near, aside;       /* m, rad */
    long first, near_ones;    /* sets that were asked for: such as none before, and near one */
} Alike;

static int make_alike(Alike *alike, double way, double speed)
{
    make_known(&alike->sets, SIMILAR, way, speed);
    alike->numbers = malloc(sizeof(double) * MOST_NUMBERS);
    alike->used = 1;
    alike->near = NEAR * (way > 0 ? way : 1);
    alike->aside = NEAR;
    return alike->sets.room && alike->numbers;
}

static void put(double *numbers, cplx value) { numbers[0] = creal(value); numbers[1] = cimag(value); }

/* Displacements before the coasts and after the last, velocities, and the heading; returns how many they are. */
static int numbers_of(const Row *row, const Marks *marks, unsigned mask, double *numbers)
{
    int held = 0, count = __builtin_popcount(mask);
    cplx before = 0;
    for (unsigned rest = mask; rest; rest &= rest - 1, held++) {
        int k = __builtin_ctz(rest);
        put(numbers + 2 * held, marks->before[k] - before);
        put(numbers + 2 * (count + 1 + held), row->W[k]);
        before = marks->before[k];
    }
    put(numbers + 2 * count, marks->before[row->trims - 1] - before);
    numbers[4 * count + 2] = row->wants_heading ? row->heading : 0;
    return 4 * count + 3;
}

/* Whether the same times, with so many seconds in all, lead to nearly the same. */
static int are_near(const Alike *alike, const double *one, const double *other, int held, double seconds)
{
    double way = 0, swing = 0;
    for (int i = 0; i <= 2 * held; i++) {
        double apart = hypot(one[2 * i] - other[2 * i], one[2 * i + 1] - other[2 * i + 1]);
        if (i <= held) way += apart; else swing = MAX(swing, apart);
    }
    double aside = fabs(off_turns(one[4 * held + 2] - other[4 * held + 2]));
    return 2 * (way + swing * seconds) <= alike->near && 2 * aside <= alike->aside;
}

/* The problem of a set with a goal that is wider, the wider the fewer its times. */
static void widen(Row *row, const Alike *alike, int held)
{
    double share = MOST + 1.5 - held;
    row->tolerance += share * alike->near;
    row->heading_tolerance += share * alike->aside;
    row->wants_heading &= row->heading_tolerance < M_PI;
    row->best = row->fixed + AND_MORE * (row->best - row->fixed);
}

/* Seconds that a set takes at least with all of its times more than 0, in every walk near this one; 0 if not known. */
static double least_inside(const Row *row, Alike *alike, const Marks *marks, unsigned mask, KnownSet *set)
{
    double numbers[4 * MOST + 3];
    int held = __builtin_popcount(mask), count = numbers_of(row, marks, mask, numbers);
    if (!set->numbers) {
        if (alike->used + count > MOST_NUMBERS) return 0;
        memcpy(alike->numbers + alike->used, numbers, sizeof(double) * (size_t)count);
        set->numbers = alike->used;
        alike->used += count;
        /* Worth a wider look only where others near it will follow. */
        if (++alike->first * EACH > alike->near_ones) return 0;
    }
    if (!are_near(alike, numbers, alike->numbers + set->numbers, held, row->best - row->fixed)) return 0;
    alike->near_ones++;
    if (set->inside > 0) return set->inside;
    Row wide = *row;
    Active on;
    widen(&wide, alike, held);
    choose(&wide, &on, mask);
    both_ways(&wide, &on, mask);
    return set->inside = MAX(wide.best - wide.fixed, 1e-300);
}

/* Marks the sets of times that cannot be faster than the best so far, as those near them cannot. */
static void exclude_alike(const Row *row, unsigned useful, Alike *alike, KnownSet **sets, char *out)
{
    Marks marks;
    set_marks(&marks, row, &alike->sets);
    double least[1 << MOST], seconds = row->best - row->fixed;
    double share = MOST + 1.5, away = cabs(marks.before[row->trims - 1] - row->goal) - row->tolerance;
    double aside = fabs(off_turns(row->heading)) - row->heading_tolerance;
    int there = away <= share * alike->near && (!row->wants_heading || aside <= share * alike->aside);
    least[0] = there ? 0 : INFINITY;
    for (unsigned mask = -useful & useful; mask; mask = (mask - useful) & useful) {
        least[mask] = INFINITY;
        for (unsigned rest = mask; rest; rest &= rest - 1) least[mask] = MIN(least[mask], least[mask & ~(rest & -rest)]);
        int straight = !row->wants_heading && too_straight(row, mask);
        sets[mask] = place_of(&alike->sets, &marks, mask);
        if (!sets[mask]) least[mask] = 0;
        else if (least[mask] >= seconds && !straight)
            least[mask] = MIN(least[mask], least_inside(row, alike, &marks, mask, sets[mask]));
        out[mask] = least[mask] >= seconds;
    }
}
