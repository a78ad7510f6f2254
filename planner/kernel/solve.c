/* The best times of one walk. */
#include "alike.c"

#define IN_VAIN 2         /* sets like one for which no multiplier was found: then none is sought */

/* With what a walk is solved: what is known of others, or nothing, and until when. */
typedef struct { Known *known; Alike *alike; double until; } Help;

/* Which sets of times need no look: 1 for those that cannot beat the best so far, as then nothing can that is
 * left of them without one of the times; 2 for those with too many straight coasts, and those looked at before. */
static void exclude(const Row *row, unsigned useful, double distance, const Help *help, const Marks *marks, char *out)
{
    cplx worth = row->worth;
    double seconds = row->best - row->fixed;
    KnownSet *like[1 << MOST];
    if (help->alike) exclude_alike(row, useful, help->alike, help->until, like, out);
    else memset(out, 0, (size_t)useful + 1);
    for (unsigned mask = useful; mask; mask = (mask - 1) & useful) {
        Active on;
        if (late(help->until)) return;
        for (unsigned rest = useful & ~mask; rest && !out[mask]; rest &= rest - 1)
            out[mask] = out[mask | (rest & -rest)] == 1;
        if (out[mask]) continue;
        if (!row->wants_heading && too_straight(row, mask)) { out[mask] = 2; continue; }
        KnownSet *known = place_of(help->known, marks, mask), *near = help->alike ? like[mask] : 0;
        if (known && known->coasting >= seconds) { out[mask] = 1; continue; }
        if (known && known->inside >= seconds) { out[mask] = 2; continue; }
        choose(row, &on, mask);
        out[mask] = MAX(least_time(row, &on, distance), least_turning(row, &on)) >= seconds
            || out_of_reach(row, &on, seconds);
        if (!out[mask] && !(near && near->unrefuted >= IN_VAIN)) {
            out[mask] = refuted(row, mask, ROUNDS / 2, &worth);
            if (near && !out[mask]) near->unrefuted++;
        }
        if (out[mask] && known) known->coasting = seconds;
    }
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
    Help now = began == INFINITY && bends ? (Help){0, 0, help->until} : *help;
    Marks marks;
    if (now.known) set_marks(&marks, row, now.known);
    if (every) {
        exclude(row, useful, distance, &now, &marks, out);
        excluded_at = row->best;
    }
    for (int size = 1; size <= most && size <= row->trims; size++)
        for (unsigned mask = 1; mask < 1u << row->trims; mask++) {
            if ((mask & ~useful) || __builtin_popcount(mask) != size || (every && out[mask])) continue;
            if (late(help->until)) return;
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
