/* Which sets of times may be not 0 in a walk, and the best of their candidates. */
#include "coasting.h"

#define ROUNDS 4          /* climbs of a bound */
#define IN_VAIN 2         /* sets like one for which no multiplier was found: then none is sought */
#define SAME_RATE 1e-12   /* of a yaw rate: closer ones are one */
#define ALL_BUT_STRAIGHT 1e-8 /* rad in all; turns that turn less are found as straight lines and corrected ... */
#define HARDLY_BENT 1e-5  /* rad in all; ... and those that turn less than this in both ways */
#define LONG 1e6          /* as long as no plan is known that says how long a coast can be */

/* Whether all times are turns at one rate. With the heading at the end bound they then take as long in whatever way
 * they share it: no multiplier is worth their seconds, and the times that are best form a family. Where it has no
 * member with a time that is 0, that would be found with fewer times, its member with the least first time is inside,
 * so it is found with seconds that only the first time costs. */
static int share_a_heading(const Problem *p, const ActiveSet *on)
{
    double rate = p->rate[on->place[0]];
    for (int i = 0; i < on->count; i++)
        if (!(fabs(p->rate[on->place[i]] - rate) <= SAME_RATE * fabs(rate))) return 0;
    return on->bound_heading && fabs(rate) > p->straight;
}

/* A walk cut where it coasts in a turn. */
typedef struct {
    int last;                    /* number of the last stretch */
    cplx A[MOST + 1];
    double rate[MOST + 2];       /* of the turn that each begins with */
    double inverse[MOST + 2];    /* 1 / rate, times what its seconds cost */
    int straight[MOST + 1][2], straights[MOST + 1]; /* places of straight coasts, how many */
    int total;                   /* straight coasts of all stretches */
} Cut;

/* Cuts a walk into stretches; 0 with more than two straight coasts: for given headings the times of straight coasts
 * solve a linear program with the two equations of the place, which needs no more of them. */
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

/* A stretch whose heading is fixed: its part of the way is known. */
static void fix_stretch(Chain *c, const Cut *cut, int j, cplx factor)
{
    c->rest -= factor * cut->A[j];
    for (int i = 0; i < cut->straights[j]; i++) {
        c->fixed_place[c->fixed] = cut->straight[j][i];
        c->fixed_velocity[c->fixed++] = factor * c->problem->W[cut->straight[j][i]];
    }
}

/* A stretch whose heading is free. */
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

/* Candidates of one set of times, the heading at the end free or bound to a limit. */
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

/* Candidates of one set of times, with every limit that the heading may be at. */
static void try_headings(Problem *p, ActiveSet *on)
{
    on->bound_heading = 0;
    /* As many times as the place needs may happen to have the heading, too. */
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

/* How many times of a set are straight. */
int straights_in(const Problem *p, unsigned mask)
{
    int count = 0;
    for (int k = 0; k < p->trims; k++) count += ((mask >> k) & 1) && fabs(p->rate[k]) <= p->straight;
    return count;
}

/* Whether a set of times cannot be faster than the best so far, by bounds that cost little. */
static int too_slow(const Problem *p, const ActiveSet *on, double distance)
{
    return p->fixed + greater(least_time(p, on, distance), time_to_turn(p, on)) >= p->best
        || (p->best < INFINITY && out_of_reach(p, on, p->best - p->fixed));
}

/* Whether multipliers refute sets of times often enough to be sought; where they do not, some still are. */
static int worth_a_climb(KnownSets *known)
{
    if (!known) return 1;
    int rarely = known->sought > TRIALS && known->refuted * RARELY < known->sought;
    if (rarely && known->passed++ % RARELY) return 0;
    known->sought++;
    return 1;
}

/* Which sets of times need no look: 1 for those that cannot beat the best so far, as then nothing can that is
 * left of them without one of the times; 2 for those with too many straight coasts, and those that other walks had. */
static void exclude(const Problem *p, unsigned useful, double distance, const Given *given, const Marks *marks,
                    char *out)
{
    const Help *help = given->help;
    cplx multiplier = p->multiplier;
    double seconds = (p->best - p->fixed) * given->second;
    KnownSet *like[1 << MOST];
    memset(out, 0, (size_t)useful + 1);
    if (help->alike) exclude_alike(p, useful, given, like, out);
    for (unsigned mask = useful; mask; mask = (mask - 1) & useful) {
        ActiveSet on;
        if (late(help->until)) return;
        for (unsigned rest = useful & ~mask; rest && !out[mask]; rest &= rest - 1)
            out[mask] = out[mask | (rest & -rest)] == 1;
        if (out[mask]) continue;
        KnownSet *known = help->known ? known_set(help->known, marks, mask) : 0;
        if (known && known->coasting >= seconds) {
            out[mask] = 1;
            continue;
        }
        if (straights_in(p, mask) > 2 || (known && known->inside >= seconds)) {
            out[mask] = 2;
            continue;
        }
        choose(p, &on, mask);
        KnownSet *near = help->alike ? like[mask] : 0;
        out[mask] = too_slow(p, &on, distance);
        if (!out[mask] && !(near && near->unrefuted >= IN_VAIN) && worth_a_climb(help->known)) {
            out[mask] = refuted(p, mask, ROUNDS, &multiplier);
            if (help->known) help->known->refuted += out[mask];
            if (near && !out[mask]) near->unrefuted++;
        }
        if (out[mask] && known) known->coasting = seconds;
    }
}

/* How slow a turn has to be to be taken as a straight line: it depends on how long it can be held. Returns the
 * slowest rate there is. */
static double set_straight(Problem *p, double distance)
{
    double longest = p->best - p->fixed, shortest = longest, fastest = 0, slowest = INFINITY;
    for (int k = 0; k < p->trims; k++) {
        fastest = greater(fastest, p->speed[k]);
        if (p->rate[k] != 0) slowest = lesser(slowest, fabs(p->rate[k]));
    }
    if (p->best == INFINITY) {
        longest = LONG;
        shortest = distance / fastest;
    }
    p->straight = ALL_BUT_STRAIGHT / longest;
    p->hardly_bent = HARDLY_BENT / shortest;
    return slowest;
}

/* Candidates of one set of times. Turns that hardly bend are taken as turns, then the slowest of them as a straight
 * line, then the next slowest too: which of them bend enough for the way to show it is not known before. */
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

/* Solves a problem in its own units, with at most so many times that are not 0, until it is late. */
void solve_in_units(Problem *p, int most, const Given *given)
{
    double distance = to_cover(p), slowest = set_straight(p, distance), began = p->best, nothing[MOST] = {0};
    unsigned useful = 0;
    for (int k = 0; k < p->trims; k++)
        if (p->W[k] != 0 || p->rate[k] != 0) useful |= 1u << k;
    update_best(p, nothing);
    char out[1 << MOST];
    double excluded_at = INFINITY;
    int every = most >= p->trims && p->best < INFINITY, bends = slowest <= p->hardly_bent;
    /* What is found while it is not known which turns count as straight lines is of no use to other walks. */
    Help own = {0, 0, given->help->until};
    Given now = {given->problem, given->metre, given->second, began == INFINITY && bends ? &own : given->help};
    KnownSets *known = now.help->known;
    Marks marks;
    if (known) set_marks(&marks, given->problem, known);
    if (every) {
        exclude(p, useful, distance, &now, &marks, out);
        excluded_at = p->best;
    }
    for (int size = 1; size <= most && size <= p->trims; size++)
        for (unsigned mask = 1; mask < 1u << p->trims; mask++) {
            if ((mask & ~useful) || __builtin_popcount(mask) != size || (every && out[mask])) continue;
            if (late(given->help->until)) return;
            KnownSet *set = known ? known_set(known, &marks, mask) : 0;
            if (set && set->inside >= (p->best - p->fixed) * given->second) continue;
            ActiveSet on;
            choose(p, &on, mask);
            if (p->best < excluded_at && too_slow(p, &on, distance)) continue;
            try_both_ways(p, &on, mask);
            if (set) set->inside = known->once ? INFINITY : (p->best - p->fixed) * given->second;
        }
    /* Which turns hardly bend is known now. */
    if (began == INFINITY && p->best < INFINITY && most >= p->trims && bends) solve_in_units(p, most, given);
}
