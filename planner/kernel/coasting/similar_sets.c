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

#define HASH_STEP 1e-3      /* of the way, of the speed, rad: numbers that are told apart */
#define RADIUS 1e-3         /* of the way, rad: sets that are near each other differ by half of it at most */
#define CAPACITY (1 << 19)    /* sets */
#define MOST_COEFFICIENTS (4 << 20) /* kept of sets: 32 MB */
#define HEADROOM 1.02     /* of the seconds that would do */
#define MEMBERS_PER_CLUSTER 4            /* sets that are near the first of their like */
#define TIGHTEN_BY 8            /* ... and if they are that much nearer */
#define LEAST_RADIUS 1e-4        /* of the nearness at first: how near they are taken to be at least */

struct SimilarSets {
    SetCache *sets;
    double *coefficients;             /* of the first sets of each like */
    int used;
    double radius, angle_radius;          /* m, rad */
    long clusters, members;          /* sets that were the first of their like, and that were near one */
    double spread[2];            /* m, rad; by which these differed most, twice */
    int tightened;                  /* whether that was looked at */
};

SimilarSets *make_similar_sets(double way, double speed)
{
    SimilarSets *similar = malloc(sizeof(SimilarSets));
    if (!similar) return 0;
    *similar = (SimilarSets){.used = 1, .radius = RADIUS * (way > 0 ? way : 1), .angle_radius = RADIUS};
    similar->sets = make_set_cache(CAPACITY, HASH_STEP, way, speed, 0);
    similar->coefficients = malloc(sizeof(double) * MOST_COEFFICIENTS);
    if (similar->sets && similar->coefficients) return similar;
    free_similar_sets(similar);
    return 0;
}

void free_similar_sets(SimilarSets *similar)
{
    if (!similar) return;
    free_set_cache(similar->sets);
    free(similar->coefficients);
    free(similar);
}

static void put(double *numbers, cplx value)
{
    numbers[0] = creal(value);
    numbers[1] = cimag(value);
}

/* Displacements before the coasts and after the last, velocities, and the heading; returns how many they are. */
static int coefficients_of(const Problem *p, const WalkHash *walk_hash, unsigned mask, double *numbers)
{
    int held = 0, count = __builtin_popcount(mask);
    cplx before = 0;
    for (unsigned rest = mask; rest; rest &= rest - 1, held++) {
        int k = __builtin_ctz(rest);
        put(numbers + 2 * held, walk_hash->before[k] - before);
        put(numbers + 2 * (count + 1 + held), p->W[k]);
        before = walk_hash->before[k];
    }
    put(numbers + 2 * count, walk_hash->before[p->trims - 1] - before);
    numbers[4 * count + 2] = p->wants_heading ? p->heading : 0;
    return 4 * count + 3;
}

/* By how much the same times, with so many seconds in all, lead elsewhere, twice: m, and rad. */
static void set_distance(const double *one, const double *other, int held, double seconds, double *distance)
{
    double way = 0, swing = 0;
    for (int i = 0; i <= 2 * held; i++) {
        double off = hypot(one[2 * i] - other[2 * i], one[2 * i + 1] - other[2 * i + 1]);
        if (i <= held) way += off;
        else swing = greater(swing, off);
    }
    distance[0] = 2 * (way + swing * seconds);
    distance[1] = 2 * fabs(off_turns(one[4 * held + 2] - other[4 * held + 2]));
}

/* Begins anew where all sets are much nearer each other than need be: goals need be less wide then. */
static void tighten_radius(SimilarSets *similar)
{
    if (similar->members < SETS_TO_LEARN || similar->tightened) return;
    similar->tightened = 1;
    if (similar->spread[0] * TIGHTEN_BY > similar->radius || similar->spread[1] * TIGHTEN_BY > similar->angle_radius) return;
    similar->radius = greater(2 * similar->spread[0], LEAST_RADIUS * similar->radius);
    similar->angle_radius = greater(2 * similar->spread[1], LEAST_RADIUS * similar->angle_radius);
    memset(similar->sets->sets, 0, sizeof(CachedSet) * (size_t)similar->sets->capacity);
    similar->sets->count = 0;
    similar->used = 1;
    similar->clusters = 0;
}

/* Whether a set is near the first one like it; it may be the first itself. */
static int in_cluster(SimilarSets *similar, const Problem *p, const WalkHash *walk_hash, unsigned mask, CachedSet *set)
{
    double numbers[4 * MOST + 3], distance[2];
    int count = coefficients_of(p, walk_hash, mask, numbers), first = !set->coefficients;
    if (first) {
        if (similar->used + count > MOST_COEFFICIENTS) return 0;
        memcpy(similar->coefficients + similar->used, numbers, sizeof(double) * (size_t)count);
        set->coefficients = similar->used;
        similar->used += count;
        similar->clusters++;
        /* Worth a look with a wider goal only where others near it will follow. */
        return similar->members > MEMBERS_PER_CLUSTER * similar->clusters;
    }
    set_distance(numbers, similar->coefficients + set->coefficients, __builtin_popcount(mask), p->best - p->fixed, distance);
    if (distance[0] > similar->radius || distance[1] > similar->angle_radius) return 0;
    similar->members++;
    for (int i = 0; i < 2; i++) similar->spread[i] = greater(similar->spread[i], distance[i]);
    return 1;
}

/* How much wider the goal of a set with so many times is. */
static double relaxation(int held) { return MOST + 1.5 - held; }

/* Seconds that a set takes at least with all of its times more than 0, with a wider goal; all in units. */
static double relaxed_bound(const Problem *p, unsigned mask, double radius, double angle_radius)
{
    Problem wide = *p;
    int held = __builtin_popcount(mask);
    wide.tolerance += relaxation(held) * radius;
    wide.heading_tolerance += relaxation(held) * angle_radius;
    wide.wants_heading &= wide.heading_tolerance < PI;
    wide.best = wide.fixed + HEADROOM * (wide.best - wide.fixed);
    if (straights_in(&wide, mask) <= 2) {
        ActiveSet on;
        choose(&wide, &on, mask);
        try_both_ways(&wide, &on, mask);
    }
    return greater(wide.best - wide.fixed, 1e-300);
}

/* Whether a wider goal is reached without coasting. */
static int reached_without_coasting(const Problem *p, const SimilarSets *similar, const WalkHash *walk_hash)
{
    double away = cabs(walk_hash->before[p->trims - 1] - p->goal) - p->tolerance;
    double aside = fabs(off_turns(p->heading)) - p->heading_tolerance;
    return away <= relaxation(0) * similar->radius && (!p->wants_heading || aside <= relaxation(0) * similar->angle_radius);
}

/* Marks the sets of times that cannot be faster than the best so far, as those near them cannot; sets: where each is
 * known. */
void exclude_similar(const Problem *p, unsigned useful, const Unscaled *unscaled, CachedSet **sets, char *out)
{
    SimilarSets *similar = unscaled->context->similar;
    tighten_radius(similar);
    Problem si = *unscaled->problem;
    si.best = si.fixed + (p->best - p->fixed) * unscaled->second;
    WalkHash walk_hash;
    hash_walk(&walk_hash, &si, similar->sets);
    double least[1 << MOST], seconds = si.best - si.fixed;
    least[0] = reached_without_coasting(&si, similar, &walk_hash) ? 0 : INFINITY;
    for (unsigned mask = -useful & useful; mask; mask = (mask - useful) & useful) {
        CachedSet *set = sets[mask] = cached_set(similar->sets, &walk_hash, mask);
        least[mask] = out[mask] = 0;
        if (!set || past_deadline(unscaled->context->deadline) || !in_cluster(similar, &si, &walk_hash, mask, set)) continue;
        if (set->bound == 0) {
            double others = INFINITY;
            for (unsigned rest = mask; rest; rest &= rest - 1) others = lesser(others, least[mask & ~(rest & -rest)]);
            if (others >= seconds)
                set->bound = lesser(
                    others, relaxed_bound(p, mask, similar->radius / unscaled->metre, similar->angle_radius) * unscaled->second);
        }
        least[mask] = set->bound;
        out[mask] = least[mask] >= seconds;
    }
}
