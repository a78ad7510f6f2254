/* Solution of one active set: the coasting times of a walk that are not 0. */
#include "coasting.h"

#define SAME_RATE 1e-12   /* of a yaw rate: closer ones are equal */

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
