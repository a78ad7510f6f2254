/* Candidates in closed form: where u is given, and where there are as many times as equations. */
#include "curves.c"

/* Two straight coasts of fixed direction, or two in one free stretch: u itself is given. */
static void given_u(Problem *p, int doubled)
{
    cplx one, two, multiplier;
    if (doubled >= 0) { one = p->stretch[doubled].w; two = p->stretch[doubled].w_other; }
    else { one = p->fixed_velocity[0]; two = p->fixed_velocity[1]; }
    double area = cross(one, two);
    if (!(fabs(area) > 1e-9 * cabs(one) * cabs(two))) return;
    multiplier = I * (two - one) / area;
    double u = 1 / cabs(multiplier);
    int others = p->free - (doubled >= 0), extra = doubled >= 0 ? p->fixed : 0;
    for (unsigned signs = 0; signs < 1u << (others + extra); signs++) {
        Point point = {.u = u};
        cplx way = -p->row->tolerance;
        int bit = 0, possible = 1;
        for (int j = 0; j < p->free && possible; j++) {
            if (j == doubled) continue;
            const Stretch *s = &p->stretch[j];
            possible = u < s->limit;
            way += add(s, u, root_of(u / s->limit, (signs >> bit++) & 1 ? -1.0 : 1.0), &point, j);
        }
        if (!possible) continue;
        if (doubled < 0) {
            point.alpha = multiplier * u;
            cplx remaining = p->rest - point.alpha * way;
            point.straight[p->fixed_place[0]] = cross(remaining, two) / area;
            point.straight[p->fixed_place[1]] = cross(one, remaining) / area;
            take(p, &point);
            continue;
        }
        const Stretch *s = &p->stretch[doubled];
        cplx chi = point.chi[doubled] = conj(multiplier) * u;
        double slope = -cimag(chi * s->w) / cimag(chi * s->w_other);
        double begin = (u * s->a - cimag(chi * s->A)) / cimag(chi * s->w_other);
        cplx base = way + chi * (s->A + begin * s->w_other), moves = chi * (s->w + slope * s->w_other);
        double solved[2];
        int count = 0;
        if (p->fixed) {
            cplx v = p->fixed_velocity[0];
            double speed = cabs(v);
            if (!(u < speed)) continue;
            point.alpha = v / speed / (-u / speed + I * root_of(u / speed, (signs >> bit) & 1 ? -1.0 : 1.0));
            cplx remaining = p->rest - point.alpha * base, moved = point.alpha * moves;
            double wide = cross(moved, v);
            if (!(fabs(wide) > 1e-12)) continue;
            solved[count++] = cross(remaining, v) / wide;
            point.straight[p->fixed_place[0]] = cross(moved, remaining) / wide;
        } else {
            double qa = dot(moves, moves), qb = dot(moves, base), qc = dot(base, base) - dot(p->rest, p->rest);
            double inside = qb * qb - qa * qc;
            if (!(inside >= 0 && qa > 0)) continue;
            solved[count++] = (-qb + sqrt(inside)) / qa;
            solved[count++] = (-qb - sqrt(inside)) / qa;
        }
        for (int i = 0; i < count; i++) {
            point.straight[s->straight] = solved[i];
            point.straight[s->other] = begin + slope * solved[i];
            if (!p->fixed) point.alpha = p->rest / (base + solved[i] * moves);
            take(p, &point);
        }
    }
}

/* The corner between two sides of a triangle, from the differences of its sides: cosines of corners between the
 * radii of slow turns all round to 1. NAN where the third side is too long or too short by more than the slack. */
static double corner(double one, double two, double third, double slack)
{
    double short_by = third - fabs(one - two), long_by = one + two - third;
    if (!(short_by >= -slack && long_by >= -slack)) return NAN;
    double near = short_by * (third + fabs(one - two)), far = long_by * (one + two + third);
    return 2 * atan2(sqrt(MAX(0.0, near)), sqrt(MAX(0.0, far)));
}

/* A straight coast meets a circle, or passes it by no more than the slack: |offset + line t| = radius. */
static int meets(cplx line, cplx offset, double radius, double slack, double *times)
{
    double square = dot(line, line), along = dot(line, offset), area = cross(line, offset), size = cabs(offset);
    if (!(fabs(area) <= (radius + slack) * sqrt(square) && square > 0)) return 0;
    double inside = radius * radius * square - area * area;
    /* The root that does not cancel, and the other from their product. */
    double larger = -along - copysign(sqrt(MAX(0.0, inside)), along);
    times[0] = larger / square;
    times[1] = larger != 0 ? (size - radius) * (size + radius) / larger : 0;
    return 2;
}

/* As many times as equations: intersections of lines and circles. */
static void determined(Problem *p)
{
    cplx heading[MOST + 2] = {0}, rest = p->rest;
    double straight[MOST] = {0}, d = p->row->tolerance;
    heading[p->free + 1] = p->last;
    if (d > 0 && p->free == 1) {
        cplx A = p->stretch[0].A;
        double opening = corner(p->stretch[0].size, cabs(rest), d, p->row->slack);
        for (int way = -1; way <= 1 && opening == opening; way += 2) {
            heading[1] = turned(carg(rest / A) + way * opening);
            from_headings(p->row, p->on, heading, straight, 0);
        }
        return;
    }
    if (d == 0 && p->free == 2) {
        cplx A = p->stretch[0].A, B = p->stretch[1].A;
        double opening = M_PI - corner(cabs(A), cabs(B), cabs(rest), p->row->slack);
        for (int way = -1; way <= 1 && opening == opening; way += 2) {
            cplx bent = turned(way * opening - carg(B / A));
            heading[1] = rest / (A + bent * B);
            heading[1] /= cabs(heading[1]);
            heading[2] = heading[1] * bent;
            from_headings(p->row, p->on, heading, straight, 0);
        }
        return;
    }
    if (p->fixed == 2) {
        double area = cross(p->fixed_velocity[0], p->fixed_velocity[1]);
        if (!(fabs(area) > 1e-12)) return;
        straight[p->fixed_place[0]] = cross(rest, p->fixed_velocity[1]) / area;
        straight[p->fixed_place[1]] = cross(p->fixed_velocity[0], rest) / area;
        from_headings(p->row, p->on, heading, straight, 0);
        return;
    }
    int within = p->free == 1 && !p->fixed;
    const Stretch *s = &p->stretch[0];
    double times[2], radius = within ? cabs(rest) : d > 0 ? d : s->size;
    int count = within ? meets(s->w, s->A, radius, p->row->slack, times)
                       : meets(-p->fixed_velocity[0], rest, radius, p->row->slack, times);
    for (int i = 0; i < count; i++) {
        straight[within ? s->straight : p->fixed_place[0]] = times[i];
        if (within) heading[1] = rest / (s->A + times[i] * s->w);
        else if (p->free) heading[1] = (rest - times[i] * p->fixed_velocity[0]) / s->A;
        from_headings(p->row, p->on, heading, straight, 0);
    }
}

/* Moves times to where they miss least. */
static void nearest(const Row *row, const Active *on, double *times)
{
    int n = on->count;
    for (int round = 0; round < 4; round++) {
        cplx velocity[MOST], miss = motion(row, times, velocity, 0) - row->goal;
        double M[MOST * MOST], b[MOST], turn = 0, off;
        for (int k = 0; k < row->trims; k++) turn += row->rate[k] * times[k];
        off = on->bound_heading ? off_turns(turn - on->target) : 0;
        for (int i = 0; i < n; i++) {
            cplx v = velocity[on->place[i]];
            double rate = on->bound_heading ? row->rate[on->place[i]] : 0;
            b[i] = -dot(v, miss) - rate * off;
            for (int j = 0; j < n; j++)
                M[i * n + j] = dot(v, velocity[on->place[j]]) + rate * row->rate[on->place[j]];
        }
        if (!eliminate(M, b, n)) return;
        for (int i = 0; i < n; i++) times[on->place[i]] += b[i];
    }
}

/* One time for the two equations of the place: right only where the goal happens to lie on its line or circle. */
static void in_line(Problem *p)
{
    double straight[MOST] = {0}, of_active[MOST], times[MOST] = {0};
    cplx heading[MOST + 2] = {0};
    if (p->free) heading[1] = p->rest / p->stretch[0].A / cabs(p->rest / p->stretch[0].A);
    else straight[p->fixed_place[0]] = creal(p->rest / p->fixed_velocity[0]);
    heading[p->free + 1] = p->last;
    times_of(p->row, p->on, heading, straight, of_active);
    for (int i = 0; i < p->on->count; i++) times[p->on->place[i]] = of_active[i];
    nearest(p->row, p->on, times);
    keep(p->row, times);
}
