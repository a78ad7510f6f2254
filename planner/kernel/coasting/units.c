/* Solver and lower bounds of one walk, in scaled units.
 *
 * Thresholds compare numbers of about 1: the unit of length is about the size of the displacements, the unit of time
 * that in which the fastest coast covers it. Units are powers of two, so that scaling does not round.
 */
#include "coasting.h"

#define CLIMBS 8          /* ascent steps of a dual bound */

typedef struct {
    Problem problem;
    double metre, second;        /* the units */
    double rate[MOST], size_D[MOST], speed[MOST];
    cplx W[MOST], C[MOST], D[MOST];
} InUnits;

/* The next power of two above a number. */
static double power_of_two(double number)
{
    int exponent;
    frexp(number, &exponent);
    return ldexp(1, exponent);
}

static void to_units(const Problem *p, InUnits *u)
{
    double size = cabs(p->goal), speed = 0;
    for (int k = 0; k < p->trims; k++) {
        size += p->size_D[k];
        speed = greater(speed, p->speed[k]);
    }
    u->metre = size > 0 ? power_of_two(size) : 1;
    u->second = speed > 0 ? power_of_two(u->metre / speed) : 1;
    for (int k = 0; k < p->trims; k++) {
        u->rate[k] = p->rate[k] * u->second;
        u->size_D[k] = p->size_D[k] / u->metre;
        u->speed[k] = p->speed[k] * u->second / u->metre;
        u->W[k] = p->W[k] * u->second / u->metre;
        u->C[k] = p->C[k] / u->metre;
        u->D[k] = p->D[k] / u->metre;
    }
    u->problem = *p;
    u->problem.rate = u->rate;
    u->problem.size_D = u->size_D;
    u->problem.speed = u->speed;
    u->problem.W = u->W;
    u->problem.C = u->C;
    u->problem.D = u->D;
    u->problem.fixed /= u->second;
    u->problem.goal /= u->metre;
    u->problem.tolerance /= u->metre;
    u->problem.slack /= u->metre;
    u->problem.best /= u->second;
    u->problem.multiplier *= u->metre / u->second;
}

/* Solves a walk at one level with at most so many nonzero times; they count if they are faster than the incumbent.
 * After the deadline they are the best so far. */
void solve_with(Problem *p, int most, const SolveContext *context)
{
    InUnits u;
    to_units(p, &u);
    double began = u.problem.best;
    solve_in_units(&u.problem, most, &(Unscaled){p, u.metre, u.second, context});
    if (!(u.problem.best < began)) return;
    p->best = p->fixed;
    for (int k = 0; k < p->trims; k++) {
        /* + 0.0 makes -0 positive. */
        p->times[k] = u.problem.times[k] * u.second + 0.0;
        p->best += p->times[k];
    }
}

void solve(Problem *p, int most) { solve_with(p, most, &(SolveContext){0, 0, INFINITY}); }

/* Lower bound of a walk at one level; infinite where the wanted heading is out of reach. */
double lower_bound(const Problem *p)
{
    ActiveSet on;
    choose(p, &on, (1u << p->trims) - 1);
    return p->fixed + greater(least_time(p, &on, to_cover(p)), time_to_turn(p, &on));
}

/* Whether a walk at one level is dominated by the incumbent, by reach or by multipliers; the best of these is kept. */
int cannot_beat(Problem *p)
{
    ActiveSet all;
    unsigned mask = (1u << p->trims) - 1;
    choose(p, &all, mask);
    return out_of_reach(p, &all, p->best - p->fixed) || refuted(p, mask, CLIMBS, &p->multiplier);
}
