/* The public face: problems in any units, solved in units of their own.
 *
 * Thresholds compare numbers of about 1: lengths are in units of the displacements, times in units of the time that
 * the fastest coast takes for them. Units are powers of two, so nothing is rounded.
 */
#include "coasting.h"

#define CLIMBS 8          /* rounds of a bound */

typedef struct {
    Problem problem;
    double metre, second;        /* what the units are in metres and seconds */
    double rate[MOST], size_D[MOST], speed[MOST];
    cplx W[MOST], C[MOST], D[MOST];
} InUnits;

/* The power of two that is next above a number. */
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

/* The best times of a walk at one level, with at most so many that are not 0; they count if they are faster than the
 * best so far. Where the time runs out they are the best that were found. */
void solve_with(Problem *p, int most, const Help *help)
{
    InUnits u;
    to_units(p, &u);
    double known = u.problem.best;
    solve_in_units(&u.problem, most, &(Given){p, u.metre, u.second, help});
    if (!(u.problem.best < known)) return;
    p->best = p->fixed;
    for (int k = 0; k < p->trims; k++) {
        /* No -0. */
        p->times[k] = u.problem.times[k] * u.second + 0.0;
        p->best += p->times[k];
    }
}

void solve(Problem *p, int most) { solve_with(p, most, &(Help){0, 0, INFINITY}); }

/* Seconds that a walk takes at least at one level; infinite where its heading cannot be as wanted. */
double lower_bound(const Problem *p)
{
    ActiveSet on;
    choose(p, &on, (1u << p->trims) - 1);
    return p->fixed + greater(least_time(p, &on, to_cover(p)), time_to_turn(p, &on));
}

/* Whether a walk cannot beat the best so far at its level, by what its coasts reach in time and by multipliers: from
 * that of the problem the best one is left there. */
int cannot_beat(Problem *p)
{
    ActiveSet all;
    unsigned mask = (1u << p->trims) - 1;
    choose(p, &all, mask);
    return out_of_reach(p, &all, p->best - p->fixed) || refuted(p, mask, CLIMBS, &p->multiplier);
}
