/* Closed-form candidates: u given by two straight coasts, or as many times as equations. */
#include "coasting.h"

#define SAME_LIMIT 1e-12  /* of a limit: excess that is rounding */
#define ROUNDING 1e-15    /* of the sides of a triangle */

/* The multiplier for which two straight coasts are stationary. */
static cplx multiplier_of(cplx one, cplx two) { return I * (two - one) / cross(one, two); }

/* Contribution of the stretches without straight coasts, with the sign -, seen from alpha, less the tolerance. (Two
 * straight coasts take both equations: no stretch may have negative curvature.) Returns 0 where u exceeds a limit. */
static int plain_way(const Chain *c, int doubled, Point *point, cplx *way)
{
    *way = -c->problem->tolerance;
    for (int j = 0; j < c->free; j++) {
        const Stretch *s = &c->stretch[j];
        if (j == doubled) continue;
        double share = point->u / s->limit;
        if (!(share <= 1 + SAME_LIMIT)) return 0;
        *way += add(s, point->u, -sqrt(greater(0, 1 - share * share)), point, j);
    }
    return 1;
}

/* Angle between two sides of a triangle, from differences of the sides: for the radii of slow turns all cosines round
 * to 1. NAN where the third side is too long or too short by more than the slack. */
static double corner(double one, double two, double third, double slack)
{
    slack += ROUNDING * (one + two);
    double beyond = third - fabs(one - two), left = one + two - third;
    if (!(beyond >= -slack && left >= -slack)) return NAN;
    double near = beyond * (third + fabs(one - two)), far = left * (one + two + third);
    return 2 * atan2(sqrt(greater(0, near)), sqrt(greater(0, far)));
}

/* Intersections of a line and a circle, |offset + line t| = radius, to within the slack. */
static int meets(cplx line, cplx offset, double radius, double slack, double *times)
{
    double square = dot(line, line), along = dot(line, offset), area = cross(line, offset), size = cabs(offset);
    slack += ROUNDING * (radius + size);
    if (!(fabs(area) <= (radius + slack) * sqrt(square) && square > 0)) return 0;
    double inside = radius * radius * square - area * area;
    /* The root without cancellation, and the other from their product. */
    double larger = -along - copysign(sqrt(greater(0, inside)), along);
    times[0] = larger / square;
    times[1] = larger != 0 ? (size - radius) * (size + radius) / larger : 0;
    return 2;
}

/* One free heading: circle and disc. */
static void turn_to_disc(Chain *c)
{
    cplx heading[MOST + 2] = {0};
    double straight[MOST] = {0};
    double opening = corner(c->stretch[0].size, cabs(c->rest), c->problem->tolerance, c->problem->slack);
    heading[2] = c->last;
    for (int side = -1; side <= 1 && opening == opening; side += 2) {
        heading[1] = unit_complex(carg(c->rest / c->stretch[0].A) + side * opening);
        propose_headings(c->problem, c->on, heading, straight, 0);
    }
}

/* Two free headings: a triangle. */
static void two_turns(Chain *c)
{
    cplx A = c->stretch[0].A, B = c->stretch[1].A, heading[MOST + 2] = {0};
    double straight[MOST] = {0};
    double opening = PI - corner(cabs(A), cabs(B), cabs(c->rest), c->problem->slack);
    heading[3] = c->last;
    for (int side = -1; side <= 1 && opening == opening; side += 2) {
        cplx rotation = unit_complex(side * opening - carg(B / A));
        heading[1] = c->rest / (A + rotation * B);
        heading[1] /= cabs(heading[1]);
        heading[2] = heading[1] * rotation;
        propose_headings(c->problem, c->on, heading, straight, 0);
    }
}

/* Two straight coasts of fixed direction: two lines. */
static void two_lines(Chain *c)
{
    cplx one = c->fixed_velocity[0], two = c->fixed_velocity[1], heading[MOST + 2] = {0};
    double straight[MOST] = {0};
    heading[c->free + 1] = c->last;
    straight[c->fixed_place[0]] = cross(c->rest, two) / cross(one, two);
    straight[c->fixed_place[1]] = cross(one, c->rest) / cross(one, two);
    propose_headings(c->problem, c->on, heading, straight, 0);
}

/* One straight coast of fixed direction: a line and a circle, that of the disc or of a free heading. */
static void line_to_circle(Chain *c)
{
    double times[2], straight[MOST] = {0}, tolerance = c->problem->tolerance;
    double radius = c->free ? c->stretch[0].size : tolerance;
    cplx heading[MOST + 2] = {0};
    heading[c->free + 1] = c->last;
    int count = meets(-c->fixed_velocity[0], c->rest, radius, c->problem->slack, times);
    for (int i = 0; i < count; i++) {
        straight[c->fixed_place[0]] = times[i];
        if (c->free) heading[1] = (c->rest - times[i] * c->fixed_velocity[0]) / c->stretch[0].A;
        propose_headings(c->problem, c->on, heading, straight, 0);
    }
}

/* One free heading with a straight coast in its stretch: a line and a circle. */
static void line_after_turn(Chain *c)
{
    const Stretch *s = &c->stretch[0];
    double times[2], straight[MOST] = {0};
    cplx heading[MOST + 2] = {0};
    heading[2] = c->last;
    int count = meets(s->w, s->A, cabs(c->rest), c->problem->slack, times);
    for (int i = 0; i < count; i++) {
        straight[s->straight] = times[i];
        heading[1] = c->rest / (s->A + times[i] * s->w);
        propose_headings(c->problem, c->on, heading, straight, 0);
    }
}

/* As many times as equations: intersections of lines and circles. */
void determined(Chain *c)
{
    if (c->fixed == 2) two_lines(c);
    else if (c->fixed == 1) line_to_circle(c);
    else if (c->straights) line_after_turn(c);
    else if (c->free == 2) two_turns(c);
    else turn_to_disc(c);
}

/* One time for the two equations of an exact goal: feasible only if the goal lies on its line or circle. */
void in_line(Chain *c)
{
    double straight[MOST] = {0};
    cplx heading[MOST + 2] = {0};
    if (c->free) heading[1] = c->rest / c->stretch[0].A / cabs(c->rest / c->stretch[0].A);
    heading[c->free + 1] = c->last;
    propose_headings(c->problem, c->on, heading, straight, 0);
}

/* Two straight coasts of fixed direction: the remaining displacement in their two directions. */
static void two_fixed(Chain *c)
{
    cplx one = c->fixed_velocity[0], two = c->fixed_velocity[1], m = multiplier_of(one, two), way;
    Point point = {.u = 1 / cabs(m)};
    if (!plain_way(c, -1, &point, &way)) return;
    point.alpha = m * point.u;
    cplx remaining = c->rest - point.alpha * way;
    point.straight[c->fixed_place[0]] = cross(remaining, two) / cross(one, two);
    point.straight[c->fixed_place[1]] = cross(one, remaining) / cross(one, two);
    set_headings(c, &point);
}

/* Two straight coasts in one stretch of free heading: stationary on a line in their times, feasible where the line
 * meets a circle. */
static void two_in_a_stretch(Chain *c, int doubled)
{
    const Stretch *s = &c->stretch[doubled];
    cplx m = multiplier_of(s->w, s->w_other), way;
    Point point = {.u = 1 / cabs(m)};
    if (!plain_way(c, doubled, &point, &way)) return;
    cplx chi = point.chi[doubled] = conj(m) * point.u;
    double slope = -cimag(chi * s->w) / cimag(chi * s->w_other);
    double begin = (point.u * s->a - cimag(chi * s->A)) / cimag(chi * s->w_other);
    cplx base = way + chi * (s->A + begin * s->w_other), moves = chi * (s->w + slope * s->w_other);
    double times[2];
    int count = meets(moves, base, cabs(c->rest), c->problem->slack, times);
    for (int i = 0; i < count; i++) {
        point.straight[s->straight] = times[i];
        point.straight[s->other] = begin + slope * times[i];
        point.alpha = c->rest / (base + times[i] * moves);
        set_headings(c, &point);
    }
}

/* Two straight coasts and more times than equations: u is that for which both coasts are stationary. */
void two_straights(Chain *c, int doubled)
{
    if (doubled < 0) two_fixed(c);
    else two_in_a_stretch(c, doubled);
}
