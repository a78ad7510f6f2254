/* A stretch's contribution and heading as functions of u.
 *
 * Along a curve u runs from 0 to `most`, the least limit of the stretches. A slow turn flown nearly straight at the
 * goal is so close to its limit that u no longer resolves its heading. So curves are parametrised by s = sqrt(most^2 -
 * u^2), and each stretch stores by how much its own limit exceeds the least one:
 *
 *     E = sqrt(limit^2 - u^2) = sqrt(above + s^2),   above = limit^2 - most^2.
 *
 * A stretch without a straight coast adds |a| E along alpha, one with a straight coast a E - K / E.
 */
#include "coasting.h"

#define BLUR 3e-8         /* rad; rounding of a heading near the end of its curve */
#define NEAR_THE_LIMIT 0.9 /* of u; beyond, the heading follows from E more precisely */

double across(const Chain *c, double s) { return sqrt(greater(0, (c->most - s) * (c->most + s))); }

/* Sets exp(i chi) of a stretch at u, times any length; returns its contribution to the displacement, seen from alpha.
 * root is +-E / limit. */
cplx add(const Stretch *s, double u, double root, Point *point, int j)
{
    if (s->straight < 0) {
        cplx seen = root + I * (s->size > 0 ? u * s->a / s->size : 0);
        point->chi[j] = s->size > 0 ? conj(s->A) * seen : seen;
        return s->size * seen;
    }
    cplx chi = conj(s->w) / s->speed * (-u / s->speed + I * root);
    double time = (u * s->a - cimag(chi * s->A)) / (s->speed * root);
    point->chi[j] = chi;
    point->straight[s->straight] = time;
    return chi * (s->A + time * s->w);
}

/* Proposes the candidate whose headings are those of a point of a curve. */
void set_headings(const Chain *c, Point *point)
{
    cplx heading[MOST + 2], alpha = point->alpha / cabs(point->alpha);
    for (int j = 0; j < c->free; j++) heading[j + 1] = alpha * point->chi[j];
    heading[c->free + 1] = c->last;
    /* At the edge of reach no multiplier is finite, and for turns that share a heading it is 0. */
    int finite = point->u > 0 && !c->on->shared;
    propose_headings(c->problem, c->on, heading, point->straight, finite ? alpha / point->u : 0);
}

double E_of(const Stretch *one, double s) { return sqrt(one->above + s * s); }

/* Contribution of a stretch along alpha, without its sign. Across alpha all stretches add u a_j, which sums to 0 with
 * the goal's. */
double along(const Stretch *one, double E)
{
    if (one->straight >= 0) return one->a * E - one->K / E;
    return one->a == 0 ? one->size : fabs(one->a) * E;
}

/* Derivative of the contribution by s. */
double slope_of(const Stretch *one, double E, double s)
{
    double rises = E > 0 ? s / E : 1;
    if (one->straight >= 0) return (one->a + one->K / (E * E)) * rises;
    return fabs(one->a) * rises;
}

/* Heading of a stretch seen from alpha, for the sign +, or mirrored for the sign -. */
double heading_of(const Stretch *one, double u, double E, int plus)
{
    double share = u / one->limit, angle = share < NEAR_THE_LIMIT ? asin(share) : acos(lesser(1, E / one->limit));
    if (one->straight >= 0) {
        angle += PI / 2;
        return (plus ? angle : -angle) - one->aside;
    }
    if (one->a < 0) angle = -angle;
    return (plus ? angle : PI - angle) - one->aside;
}

/* Proposes the candidate at a point of a curve. */
void emit_times(const Chain *c, const double *signs, double s)
{
    Point point = {.u = across(c, s)};
    for (int j = 0; j <= c->free; j++) {
        const Stretch *one = &c->stretch[j];
        double root = one->limit < INFINITY ? E_of(one, s) / one->limit : 1;
        add(one, point.u, signs[j] * root, &point, j);
    }
    point.alpha = conj(point.chi[c->free]);
    set_headings(c, &point);
}

/* Least duration of the turn between two headings that are monotone between two points of a curve. */
static double least_turn(double rate, double from, double from_end, double to, double to_end)
{
    double low = lesser(to, to_end) - greater(from, from_end), high = greater(to, to_end) - lesser(from, from_end);
    if (rate < 0) {
        double swap = -low;
        low = -high;
        high = swap;
    }
    low -= BLUR;
    double rest = off_turns(low);
    if (rest < 0) rest += 2 * PI;
    return rest + (high + BLUR - low) >= 2 * PI ? 0 : rest / fabs(rate);
}

/* Whether the turns exceed the seconds left everywhere between two points of a curve with given headings. Straight
 * lines in place of slow turns have no such bound. */
int turns_too_long(const Chain *c, const double *from, const double *to)
{
    if (c->on->slow) return 0;
    double spent = 0, allowed = c->problem->best - c->problem->fixed;
    for (int j = 0; j <= c->free; j++) {
        /* The goal's own heading is -alpha: fixed headings are seen from alpha through it. */
        int before = j ? j - 1 : c->free;
        if (j < c->free) spent += least_turn(c->stretch[j].rate, from[before], to[before], from[j], to[j]);
        else if (c->last_rate != 0)
            spent += least_turn(c->last_rate, from[before], to[before], c->on->target + from[j],
                                c->on->target + to[j]);
        if (!(spent < allowed)) return 1;
    }
    return 0;
}
