/* Candidates in closed form: where u is given, and where there are as many times as equations. */
#include "curves.c"

/* Two straight coasts of fixed direction, or two in one free stretch: u itself is given. */
static void given_u(Problem *p, int doubled)
{
    cplx one, two, multiplier;
    if (doubled >= 0) { one = conj(p->stretch[doubled].w); two = conj(p->stretch[doubled].w_other); }
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

/* As many times as equations: intersections of lines and circles. */
static void determined(Problem *p)
{
    cplx heading[MOST + 2] = {0}, rest = p->rest;
    double straight[MOST] = {0}, d = p->row->tolerance;
    heading[p->free + 1] = p->last;
    if (d > 0 && p->free == 1) {
        cplx A = p->stretch[0].A;
        double cosine = (dot(A, A) + dot(rest, rest) - d * d) / (2 * cabs(A) * cabs(rest));
        if (!(fabs(cosine) <= 1)) return;
        for (int way = -1; way <= 1; way += 2) {
            heading[1] = turned(carg(rest / A) + way * acos(cosine));
            from_headings(p->row, p->on, heading, straight, 0);
        }
        return;
    }
    if (d == 0 && p->free == 2) {
        cplx A = p->stretch[0].A, B = p->stretch[1].A;
        double cosine = (dot(rest, rest) - dot(A, A) - dot(B, B)) / (2 * cabs(A) * cabs(B));
        if (!(fabs(cosine) <= 1 + 1e-12)) return;
        double opening = acos(MAX(-1.0, MIN(1.0, cosine)));
        for (int way = -1; way <= 1; way += 2) {
            cplx bent = turned(way * opening - carg(B / A));
            heading[1] = rest / (A + bent * B);
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
    /* |offset + line t| = radius: a straight coast meets a circle. */
    int within = p->free == 1 && !p->fixed;
    const Stretch *s = &p->stretch[0];
    cplx line = within ? s->w : -p->fixed_velocity[0], offset = within ? s->A : rest;
    double radius = within ? cabs(rest) : d > 0 ? d : s->size;
    double square = dot(line, line), along = dot(line, offset), area = cross(line, offset);
    double inside = radius * radius * square - area * area;
    if (!(inside >= -1e-12 * radius * radius * square && square > 0)) return;
    for (int way = -1; way <= 1; way += 2) {
        double time = (-along + way * sqrt(MAX(0.0, inside))) / square;
        straight[within ? s->straight : p->fixed_place[0]] = time;
        if (within) heading[1] = rest / (s->A + time * s->w);
        else if (p->free) heading[1] = (rest + time * line) / s->A;
        from_headings(p->row, p->on, heading, straight, 0);
    }
}

/* One time for two equations: right only where the goal happens to lie on its line or circle. */
static void in_line(Problem *p)
{
    double times[MOST] = {0};
    const Active *on = p->on;
    if (on->bound_heading || on->count != 1) return;
    int place = on->place[0];
    if (p->free) {
        double rate = p->row->rate[place], time = carg(p->rest / p->stretch[0].A) / rate;
        times[place] = time < 0 ? time + 2 * M_PI / fabs(rate) : time;
    } else
        times[place] = creal(p->rest / p->fixed_velocity[0]);
    keep(p->row, times);
}
