/* Which sets of times may be not 0 in a walk, and the best times of it. */
#include "known.c"

/* Whether a set of times has more straight coasts than `examine` has equations for: three between two turns (or
 * before the first), twice two between turns, or more than two stretches between turns with one. */
static int too_straight(const Row *row, unsigned mask)
{
    int here = 0, first = 1, doubled = 0, stretches = 0;
    for (int k = 0; k < row->trims; k++) {
        if (!((mask >> k) & 1)) continue;
        if (fabs(row->rate[k]) > row->straight) { here = 0; first = 0; continue; }
        here++;
        if (here > 2) return 1;
        if (!first) { stretches += here == 1; doubled += here == 2; }
    }
    return stretches > 2 || doubled > 1;
}

/* Which sets of times need no look: 1 for those that cannot beat the best so far, as then nothing can that is
 * left of them without one of the times; 2 for those with too many straight coasts, and those looked at before. */
static void exclude(const Row *row, unsigned useful, double distance, const Help *help, const Marks *marks, char *out)
{
    cplx worth = row->worth;
    double seconds = row->best - row->fixed;
    for (unsigned mask = useful; mask; mask = (mask - 1) & useful) {
        Active on;
        if (late(help)) return;
        out[mask] = 0;
        for (unsigned rest = useful & ~mask; rest && !out[mask]; rest &= rest - 1)
            out[mask] = out[mask | (rest & -rest)] == 1;
        if (out[mask]) continue;
        if (!row->wants_heading && too_straight(row, mask)) { out[mask] = 2; continue; }
        KnownSet *known = place_of(help->known, marks, mask);
        if (known && known->coasting >= seconds) { out[mask] = 1; continue; }
        if (known && known->inside >= seconds) { out[mask] = 2; continue; }
        choose(row, &on, mask);
        out[mask] = MAX(least_time(row, &on, distance), least_turning(row, &on)) >= seconds
            || out_of_reach(row, &on, seconds)
            || refuted(row, mask, ROUNDS / 2, &worth);
        if (out[mask] && known) known->coasting = seconds;
    }
}

/* How slow a turn has to be to be taken as a straight line: it depends on how long it can be held. Returns the
 * slowest rate there is. */
static double set_straight(Row *row, double distance)
{
    double longest = row->best - row->fixed, shortest = longest, fastest = 0, slowest = INFINITY;
    for (int k = 0; k < row->trims; k++) {
        fastest = MAX(fastest, row->speed[k]);
        if (row->rate[k] != 0) slowest = MIN(slowest, fabs(row->rate[k]));
    }
    if (row->best == INFINITY) { longest = LONG; shortest = distance / fastest; }
    row->straight = ALL_BUT_STRAIGHT / MAX(longest, 1e-3);
    row->hardly_bent = HARDLY_BENT / MAX(shortest, 1e-3);
    return slowest;
}

/* Candidates of one set of times. Turns that hardly bend are taken as turns, then the slowest of them as a straight
 * line, then the next slowest too: which of them bend enough for the way to show it is not known before. */
static void both_ways(Row *row, Active *on, unsigned mask)
{
    both_headings(row, on);
    if (!(on->slowest <= row->hardly_bent)) return;
    double straight = row->straight;
    for (;;) {
        double next = INFINITY;
        for (int i = 0; i < on->count; i++) {
            double rate = fabs(row->rate[on->place[i]]);
            if (rate > row->straight && rate <= row->hardly_bent) next = MIN(next, rate);
        }
        if (next == INFINITY) break;
        row->straight = next;
        choose(row, on, mask);
        both_headings(row, on);
    }
    row->straight = straight;
}

/* Whether a set of times need not be examined, and is not known to. */
static int slower(const Row *row, const Active *on, double distance)
{
    return row->fixed + MAX(least_time(row, on, distance), least_turning(row, on)) >= row->best
        || (row->best < INFINITY && out_of_reach(row, on, row->best - row->fixed));
}

/* The best times of a row, with at most so many that are not 0; the best so far where there is no more time. */
static void solve(Row *row, int most, const Help *help)
{
    double distance = to_cover(row), slowest = set_straight(row, distance), began = row->best;
    unsigned useful = 0;
    for (int k = 0; k < row->trims; k++)
        if (row->W[k] != 0 || row->rate[k] != 0) useful |= 1u << k;
    double nothing[MOST] = {0};
    keep(row, nothing);
    char out[1 << MOST];
    double excluded_at = INFINITY;
    int every = most >= row->trims && row->best < INFINITY, bends = slowest <= row->hardly_bent;
    /* What turns count as straight lines is not known yet. */
    Help now = {began == INFINITY && bends ? 0 : help->known, help->until};
    Marks marks;
    if (now.known) set_marks(&marks, row, now.known);
    if (every) {
        exclude(row, useful, distance, &now, &marks, out);
        excluded_at = row->best;
    }
    for (int size = 1; size <= most && size <= row->trims; size++)
        for (unsigned mask = 1; mask < 1u << row->trims; mask++) {
            if ((mask & ~useful) || __builtin_popcount(mask) != size || (every && out[mask])) continue;
            if (late(help)) return;
            KnownSet *set = place_of(now.known, &marks, mask);
            if (set && set->inside >= row->best - row->fixed) continue;
            Active on;
            choose(row, &on, mask);
            if (row->best < excluded_at && slower(row, &on, distance)) continue;
            both_ways(row, &on, mask);
            if (set) set->inside = now.known->once ? INFINITY : row->best - row->fixed;
        }
    if (began == INFINITY && row->best < INFINITY && most >= row->trims && bends) solve(row, most, help);
}
