/* Enumeration of active sets, pruned by lower bounds. */
#include "coasting.h"

#define ROUNDS 4          /* ascent steps of a dual bound */
#define FAILED_ASCENTS 2  /* failed ascents in a cluster after which none is tried */
#define ALL_BUT_STRAIGHT 1e-8 /* rad in the seconds left; slower turns are straight lines, corrected afterwards ... */
#define HARDLY_BENT 1e-5  /* ... and slower ones than this are solved both ways */
#define LONGEST 1e6       /* seconds left, without an incumbent */

/* Whether a cheap lower bound of a set is no better than the incumbent. */
static int too_slow(const Problem *p, const ActiveSet *on, double distance)
{
    return p->fixed + greater(least_time(p, on, distance), time_to_turn(p, on)) >= p->best
        || (p->best < INFINITY && out_of_reach(p, on, p->best - p->fixed));
}

/* Whether multipliers prune sets often enough; where they rarely do, most sets skip them. */
static int is_worth_ascending(SetCache *cache)
{
    if (!cache) return 1;
    int rarely = cache->climbs > MIN_TRIALS && cache->prunings * RARE_SUCCESS < cache->climbs;
    if (rarely && cache->skipped++ % RARE_SUCCESS) return 0;
    cache->climbs++;
    return 1;
}

/* Prunes active sets: 1 where no times of 0 or more beat the incumbent, so that all subsets are pruned, too; 2 where
 * only the set itself is dominated: too many straight coasts, or solved for another walk. */
static void exclude(const Problem *p, unsigned useful, double distance, const Unscaled *unscaled,
                    const WalkHash *walk_hash, char *out)
{
    const SolveContext *context = unscaled->context;
    cplx multiplier = p->multiplier;
    double seconds = (p->best - p->fixed) * unscaled->second;
    CachedSet *clusters[1 << MOST];
    memset(out, 0, (size_t)useful + 1);
    if (context->similar) exclude_similar(p, useful, unscaled, clusters, out);
    for (unsigned mask = useful; mask; mask = (mask - 1) & useful) {
        ActiveSet on;
        if (past_deadline(context->deadline)) return;
        for (unsigned rest = useful & ~mask; rest && !out[mask]; rest &= rest - 1)
            out[mask] = out[mask | (rest & -rest)] == 1;
        if (out[mask]) continue;
        CachedSet *set = context->cache ? cached_set(context->cache, walk_hash, mask) : 0;
        if (set && set->bound >= seconds) {
            out[mask] = 1;
            continue;
        }
        if (straights_in(p, mask) > 2 || (set && set->interior_bound >= seconds)) {
            out[mask] = 2;
            continue;
        }
        choose(p, &on, mask);
        CachedSet *cluster = context->similar ? clusters[mask] : 0;
        out[mask] = too_slow(p, &on, distance);
        int hopeless = cluster && cluster->failed_climbs >= FAILED_ASCENTS;
        if (!out[mask] && !hopeless && is_worth_ascending(context->cache)) {
            out[mask] = refuted(p, mask, ROUNDS, &multiplier);
            if (context->cache) context->cache->prunings += out[mask];
            if (cluster && !out[mask]) cluster->failed_climbs++;
        }
        if (out[mask] && set) set->bound = seconds;
    }
}

/* Sets the rates below which turns count as straight, by the seconds left; returns the slowest rate. */
static double set_straight(Problem *p, double distance)
{
    double longest = p->best - p->fixed, shortest = longest, fastest = 0, slowest = INFINITY;
    for (int k = 0; k < p->trims; k++) {
        fastest = greater(fastest, p->speed[k]);
        if (p->rate[k] != 0) slowest = lesser(slowest, fabs(p->rate[k]));
    }
    if (p->best == INFINITY) {
        longest = LONGEST;
        shortest = distance / fastest;
    }
    p->straight = ALL_BUT_STRAIGHT / longest;
    p->hardly_bent = HARDLY_BENT / shortest;
    return slowest;
}

/* Solves a scaled problem with at most so many nonzero times, until the deadline. */
void solve_in_units(Problem *p, int most, const Unscaled *unscaled)
{
    double distance = to_cover(p), slowest = set_straight(p, distance), began = p->best, nothing[MOST] = {0};
    unsigned useful = 0;
    for (int k = 0; k < p->trims; k++)
        if (p->W[k] != 0 || p->rate[k] != 0) useful |= 1u << k;
    update_best(p, nothing);
    char out[1 << MOST];
    double excluded_at = INFINITY;
    int every = most >= p->trims && p->best < INFINITY, bends = slowest <= p->hardly_bent;
    /* Without an incumbent it is not known which turns count as straight: nothing is cached then. */
    SolveContext own = {0, 0, unscaled->context->deadline};
    Unscaled now = *unscaled;
    if (began == INFINITY && bends) now.context = &own;
    SetCache *cache = now.context->cache;
    WalkHash walk_hash;
    if (cache) hash_walk(&walk_hash, unscaled->problem, cache);
    if (every) {
        exclude(p, useful, distance, &now, &walk_hash, out);
        excluded_at = p->best;
    }
    for (int size = 1; size <= most && size <= p->trims; size++)
        for (unsigned mask = 1; mask < 1u << p->trims; mask++) {
            if ((mask & ~useful) || __builtin_popcount(mask) != size || (every && out[mask])) continue;
            if (past_deadline(unscaled->context->deadline)) return;
            CachedSet *set = cache ? cached_set(cache, &walk_hash, mask) : 0;
            if (set && set->interior_bound >= (p->best - p->fixed) * unscaled->second) continue;
            ActiveSet on;
            choose(p, &on, mask);
            if (p->best < excluded_at && too_slow(p, &on, distance)) continue;
            try_both_ways(p, &on, mask);
            if (set) set->interior_bound = cache->once ? INFINITY : (p->best - p->fixed) * unscaled->second;
        }
    /* Now it is known. */
    if (began == INFINITY && p->best < INFINITY && most >= p->trims && bends) solve_in_units(p, most, unscaled);
}
