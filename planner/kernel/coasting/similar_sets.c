/* Lower bounds for clusters of similar active sets.
 *
 * Where maneuvers differ by little, many walks have the same trims with nearly the same displacements between. If the
 * tolerance is enlarged by the difference, every plan of one set is a plan of the other: one solution with an enlarged
 * tolerance is a lower bound for all sets of a cluster.
 *
 * That solution has all times above 0. The best plan of a set may have fewer; then it belongs to a smaller set, whose
 * tolerance is enlarged by more, as members of two clusters differ. So the bound of a set is the least of its own and
 * those of all smaller sets.
 */
#include "coasting.h"
#include <stdlib.h>

#define HASH_STEP 1e-3    /* of length, speed and rad: rounding of the hashed coefficients */
#define RADIUS 1e-3       /* of length, rad; members differ from the first of their cluster by at most half of it */
#define CAPACITY (1 << 19) /* active sets */
#define MOST_COEFFICIENTS (4 << 20) /* of the first members: 32 MB */
#define HEADROOM 1.02     /* of the incumbent's coasting time: the limit of a relaxed solution */
#define MEMBERS_PER_CLUSTER 4 /* members of a cluster, on average, from which a relaxed solution pays */
#define TIGHTEN_BY 8      /* times: clusters that are so much narrower get a smaller radius */
#define LEAST_RADIUS 1e-4 /* of the first radius */

struct SimilarSets {
    SetCache *sets;
    double *coefficients;        /* of the first member of each cluster */
    int used;
    double radius, angle_radius; /* m, rad */
    long clusters, members;      /* how many there are */
    double spread[2];            /* m, rad; twice the largest distance of a member */
    int tightened;               /* whether the radius was adapted */
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

/* Lists the coefficients of a set: displacements, velocities, heading. Returns their number. */
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

/* Twice the difference of the ends, m and rad, that the same times lead to in two sets. */
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

/* Starts again with a smaller radius where all clusters are much narrower than the first one allows. */
static void tighten_radius(SimilarSets *similar)
{
    if (similar->members < SETS_TO_LEARN || similar->tightened) return;
    similar->tightened = 1;
    if (similar->spread[0] * TIGHTEN_BY > similar->radius) return;
    if (similar->spread[1] * TIGHTEN_BY > similar->angle_radius) return;
    similar->radius = greater(2 * similar->spread[0], LEAST_RADIUS * similar->radius);
    similar->angle_radius = greater(2 * similar->spread[1], LEAST_RADIUS * similar->angle_radius);
    memset(similar->sets->sets, 0, sizeof(CachedSet) * (size_t)similar->sets->capacity);
    similar->sets->count = 0;
    similar->used = 1;
    similar->clusters = 0;
}

/* Whether a set is a member of its cluster, and the cluster large enough to pay. */
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
        /* The first member pays only where clusters have several. */
        return similar->members > MEMBERS_PER_CLUSTER * similar->clusters;
    }
    const double *first_member = similar->coefficients + set->coefficients;
    set_distance(numbers, first_member, __builtin_popcount(mask), p->best - p->fixed, distance);
    if (distance[0] > similar->radius || distance[1] > similar->angle_radius) return 0;
    similar->members++;
    for (int i = 0; i < 2; i++) similar->spread[i] = greater(similar->spread[i], distance[i]);
    return 1;
}

/* Radii by which the tolerance is enlarged for a set of so many times. */
static double relaxation(int held) { return MOST + 1.5 - held; }

/* Lower bound of the seconds with all times above 0, for an enlarged tolerance; in scaled units. */
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

/* Whether the enlarged tolerance is reached without coasting. */
static int reached_without_coasting(const Problem *p, const SimilarSets *similar, const WalkHash *walk_hash)
{
    double away = cabs(walk_hash->before[p->trims - 1] - p->goal) - p->tolerance;
    double aside = fabs(off_turns(p->heading)) - p->heading_tolerance;
    if (!(away <= relaxation(0) * similar->radius)) return 0;
    return !p->wants_heading || aside <= relaxation(0) * similar->angle_radius;
}

/* Prunes the active sets whose clusters cannot beat the incumbent; lists the entries of all sets. */
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
        if (!set || past_deadline(unscaled->context->deadline)) continue;
        if (!in_cluster(similar, &si, &walk_hash, mask, set)) continue;
        if (set->bound == 0) {
            double others = INFINITY;
            for (unsigned rest = mask; rest; rest &= rest - 1) others = lesser(others, least[mask & ~(rest & -rest)]);
            if (others >= seconds) {
                double own = relaxed_bound(p, mask, similar->radius / unscaled->metre, similar->angle_radius);
                set->bound = lesser(others, own * unscaled->second);
            }
        }
        least[mask] = set->bound;
        out[mask] = least[mask] >= seconds;
    }
}
