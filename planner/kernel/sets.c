/* Which sets of times may be not 0 in a walk, and the best of their candidates. */
#include "duality.c"

/* Candidates of one set of times, the heading at the end free or bound to a limit. */
static void examine(Row *row, Active *on)
{
    Problem p = {.row = row, .on = on, .last = 1};
    cplx A[MOST + 1] = {0};
    double inverse[MOST + 2] = {0}, rate[MOST + 2] = {0};
    int straight[MOST + 1][2], straights[MOST + 1] = {0}, stretch = 0, next = 0, count = 0;
    for (int k = 0; k < row->trims; k++) {
        A[stretch] += row->D[k];
        if (next >= on->count || on->place[next] != k) continue;
        next++;
        if (fabs(row->rate[k]) > row->straight) {
            A[stretch] -= row->C[k];
            A[++stretch] = row->C[k];
            rate[stretch] = row->rate[k];
            inverse[stretch] = 1 / row->rate[k];
        } else {
            if (straights[stretch] == 2) return;
            straight[stretch][straights[stretch]++] = k;
            count++;
        }
    }
    int last = on->bound_heading ? stretch : -1, doubled = -1;
    if (on->bound_heading && !stretch) return;
    p.rest = row->goal;
    if (last >= 0) { p.last = turned(on->target); p.last_rate = rate[last]; }
    for (int j = 0; j <= stretch; j++) {
        cplx factor = j == last ? p.last : 1;
        if (j == 0 || j == last) {
            p.rest -= factor * A[j];
            for (int i = 0; i < straights[j]; i++) {
                if (p.fixed == 2) return;
                p.fixed_place[p.fixed] = straight[j][i];
                p.fixed_velocity[p.fixed++] = factor * row->W[straight[j][i]];
            }
            continue;
        }
        Stretch *s = &p.stretch[p.free];
        s->A = A[j];
        s->rate = rate[j];
        s->a = inverse[j] - (j < stretch ? inverse[j + 1] : 0);
        s->size = cabs(A[j]);
        s->straight = s->other = -1;
        s->limit = s->size / fabs(s->a);
        if (!(s->limit < 1e100)) { s->a = 0; s->limit = INFINITY; }
        if (straights[j]) {
            s->straight = straight[j][0];
            s->w = row->W[s->straight];
            s->limit = s->speed = cabs(s->w);
        }
        if (straights[j] == 2) {
            if (doubled >= 0) return;
            doubled = p.free;
            s->other = straight[j][1];
            s->w_other = row->W[s->other];
        }
        p.free++;
    }
    int equations = row->tolerance > 0 ? 1 : 2, unknown = p.free + count;
    if (unknown == 1 && equations == 2) { in_line(&p); return; }
    if (unknown < equations) return;
    if (unknown == equations) determined(&p);
    else if (doubled >= 0) { if (p.fixed < 2) given_u(&p, doubled); }
    else if (p.fixed == 2) given_u(&p, -1);
    else all_curves(&p);
}

static void both_headings(Row *row, Active *on)
{
    on->bound_heading = 0;
    /* As many times as the place needs may happen to have the heading, too. */
    if (!row->wants_heading || row->heading_tolerance > 0 || !on->turns || on->count <= 2 - (row->tolerance > 0))
        examine(row, on);
    if (!row->wants_heading || !on->turns) return;
    on->bound_heading = 1;
    for (int side = -1; side <= 1; side += 2) {
        on->target = row->heading + side * row->heading_tolerance;
        if (on->count == 1) {
            double rate = row->rate[on->place[0]], angle = remainder(on->target, 2 * M_PI);
            double times[MOST] = {0}, time = angle / rate;
            times[on->place[0]] = time < 0 ? time + 2 * M_PI / fabs(rate) : time;
            keep(row, times);
        }
        examine(row, on);
        if (row->heading_tolerance == 0) break;
    }
}

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
