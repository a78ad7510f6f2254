/* Enumeration of active sets: the coasting times of a walk that are not 0. */
#include "coasting.h"

#define ROUNDS 4          /* ascent steps of a dual bound */
#define FAILED_ASCENTS 2  /* failed ascents in a cluster after which none is tried */
#define SAME_RATE 1e-12   /* of a yaw rate: closer ones are equal */
#define ALL_BUT_STRAIGHT 1e-8 /* rad in the seconds left; slower turns are straight lines, corrected afterwards ... */
#define HARDLY_BENT 1e-5  /* ... and slower ones than this are solved both ways */
#define LONGEST 1e6       /* seconds left, without an incumbent */

/* Whether all times are turns at one rate with the final heading bound. Then only their sum is determined: the best
 * times form a family, and the multiplier is 0. The member with the least first time is a candidate, found with a cost
 * of the first time alone; members with a time of 0 belong to smaller active sets. */
static int share_a_heading(const Problem *p, const ActiveSet *on)
{
    double rate = p->rate[on->place[0]];
    for (int i = 0; i < on->count; i++)
        if (!(fabs(p->rate[on->place[i]] - rate) <= SAME_RATE * fabs(rate))) return 0;
    return on->bound_heading && fabs(rate) > p->straight;
}

/* A walk cut into stretches at the coasts that turn. */
typedef struct {
    int last;                    /* index of the last stretch */
    cplx A[MOST + 1];
    double rate[MOST + 2];       /* rad/s; of the turn at the beginning of each stretch */
    double inverse[MOST + 2];    /* 1 / rate, times the cost of its seconds */
    int straight[MOST + 1][2], straights[MOST + 1]; /* indices and number of straight coasts in each stretch */
    int total;                   /* straight coasts in all stretches */
} Cut;

/* Cuts a walk into stretches. Returns 0 with more than two straight coasts: for given headings their times solve a
 * linear program with two equations, which has a solution with two. */
static int cut_walk(const Problem *p, const ActiveSet *on, Cut *cut)
{
    int next = 0;
    *cut = (Cut){0};
    for (int k = 0; k < p->trims; k++) {
        cut->A[cut->last] += p->D[k];
        if (on->place[next] != k) continue;
        next++;
        if (fabs(p->rate[k]) > p->straight) {
            cut->A[cut->last++] -= p->C[k];
            cut->A[cut->last] = p->C[k];
            cut->rate[cut->last] = p->rate[k];
            if (!on->shared || cut->last == 1) cut->inverse[cut->last] = 1 / p->rate[k];
        } else {
            if (cut->total++ == 2) return 0;
            cut->straight[cut->last][cut->straights[cut->last]++] = k;
        }
    }
    return 1;
}

/* Adds a stretch of fixed heading. */
static void fix_stretch(Chain *c, const Cut *cut, int j, cplx factor)
{
    c->rest -= factor * cut->A[j];
    for (int i = 0; i < cut->straights[j]; i++) {
        c->fixed_place[c->fixed] = cut->straight[j][i];
        c->fixed_velocity[c->fixed++] = factor * c->problem->W[cut->straight[j][i]];
    }
}

/* Adds a stretch of free heading. */
static void free_stretch(Chain *c, const Cut *cut, int j)
{
    Stretch *s = &c->stretch[c->free++];
    double before = cut->inverse[j], after = j < cut->last ? cut->inverse[j + 1] : 0;
    *s = (Stretch){.A = cut->A[j], .size = cabs(cut->A[j]), .rate = cut->rate[j], .straight = -1, .other = -1};
    if (fabs(before - after) > SAME_RATE * fabs(before)) s->a = before - after;
    s->limit = s->size / fabs(s->a);
    if (!(s->limit < LIMITLESS)) {
        s->a = 0;
        s->limit = INFINITY;
    }
    if (!cut->straights[j]) return;
    s->straight = cut->straight[j][0];
    s->w = c->problem->W[s->straight];
    s->limit = s->speed = cabs(s->w);
    if (cut->straights[j] == 1) return;
    s->other = cut->straight[j][1];
    s->w_other = c->problem->W[s->other];
}

/* Solves one active set, with the final heading free or bound to a limit. */
static void examine(Problem *p, ActiveSet *on)
{
    Chain c = {.problem = p, .on = on, .last = 1, .rest = p->goal};
    Cut cut;
    on->shared = share_a_heading(p, on);
    if (!cut_walk(p, on, &cut)) return;
    int bound = on->bound_heading ? cut.last : 0, doubled = -1;
    if (bound) {
        c.last = unit_complex(on->target);
        c.last_rate = cut.rate[bound];
    }
    for (int j = 0; j <= cut.last; j++) {
        if (!j) fix_stretch(&c, &cut, j, 1);
        else if (j == bound) fix_stretch(&c, &cut, j, c.last);
        else {
            if (cut.straights[j] == 2) doubled = c.free;
            free_stretch(&c, &cut, j);
        }
    }
    c.straights = cut.total;
    int equations = p->tolerance > 0 ? 1 : 2, unknown = c.free + c.straights;
    if (unknown < equations) {
        if (unknown) in_line(&c);
    } else if (unknown == equations) determined(&c);
    else if (c.fixed == 2 || doubled >= 0) two_straights(&c, doubled);
    else all_curves(&c);
}

/* Solves one active set for a free final heading and for each of its limits. */
static void try_headings(Problem *p, ActiveSet *on)
{
    on->bound_heading = 0;
    /* With as many times as equations the final heading may be right by chance. */
    if (!p->wants_heading || p->heading_tolerance > 0 || !on->turns || on->count <= 2 - (p->tolerance > 0))
        examine(p, on);
    if (!p->wants_heading || !on->turns) return;
    on->bound_heading = 1;
    for (int side = -1; side <= 1; side += 2) {
        on->target = p->heading + side * p->heading_tolerance;
        if (on->count == 1) {
            double rate = p->rate[on->place[0]], times[MOST] = {0}, time = off_turns(on->target) / rate;
            times[on->place[0]] = time < 0 ? time + 2 * PI / fabs(rate) : time;
            update_best(p, times);
        }
        examine(p, on);
        if (p->heading_tolerance == 0) break;
    }
}

/* Number of straight coasts in a set. */
int straights_in(const Problem *p, unsigned mask)
{
    int count = 0;
    for (int k = 0; k < p->trims; k++) count += ((mask >> k) & 1) && fabs(p->rate[k]) <= p->straight;
    return count;
}

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

/* Solves one active set with its nearly straight turns as turns, then with the slowest as a straight line, then with
 * the next slowest, too. */
void try_both_ways(Problem *p, ActiveSet *on, unsigned mask)
{
    double straight = p->straight;
    for (;;) {
        try_headings(p, on);
        double next = INFINITY;
        for (int i = 0; i < on->count; i++) {
            double rate = fabs(p->rate[on->place[i]]);
            if (rate > p->straight && rate <= p->hardly_bent) next = lesser(next, rate);
        }
        if (next == INFINITY) break;
        p->straight = next;
        choose(p, on, mask);
    }
    p->straight = straight;
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
