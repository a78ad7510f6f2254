/* The one equation in u, and the closed forms: see times.c. */
#include "times.c"

typedef struct {
    Row *row;
    const Active *on;
    int free;                    /* stretches with a free heading; after them the goal's, which closes the way */
    Stretch stretch[MOST + 2];
    int fixed;                   /* straight coasts whose direction is fixed */
    int fixed_place[MOST];
    cplx fixed_velocity[MOST];
    cplx rest;                   /* goal less everything that is fixed */
    cplx last;                   /* factor of a fixed last heading */
    double last_rate;            /* of the turn that leads to it; 0 where the last heading is free */
    double most;                 /* largest u */
} Problem;

typedef struct {
    double u;
    cplx alpha;                  /* exp(i alpha) */
    cplx chi[MOST + 2];          /* exp(i chi_j) */
    double straight[MOST];
} Point;

static double root_of(double share, double sign) { return sign * sqrt(MAX(0.0, 1 - share * share)); }

/* exp(i chi) of a stretch at u, and what the stretch adds to the way, seen from alpha. */
static cplx add(const Stretch *s, double u, double c, Point *point, int j)
{
    if (s->straight < 0) {
        cplx seen = c + I * (s->size > 0 ? u * s->a / s->size : 0);
        point->chi[j] = s->size > 0 ? conj(s->A) / s->size * seen : seen;
        return s->size * seen;
    }
    cplx chi = conj(s->w) / s->speed * (-u / s->speed + I * c);
    double time = (u * s->a - cimag(chi * s->A)) / (s->speed * c);
    point->chi[j] = chi;
    point->straight[s->straight] = time;
    return chi * (s->A + time * s->w);
}

static void take(const Problem *p, Point *point)
{
    cplx heading[MOST + 2], alpha = point->alpha / cabs(point->alpha);
    for (int j = 0; j < p->free; j++) heading[j + 1] = alpha * point->chi[j];
    heading[p->free + 1] = p->last;
    from_headings(p->row, p->on, heading, point->straight, alpha / point->u);
}

/* What a stretch adds along alpha, but for its sign, at u = most sin(angle); and how that changes with the angle.
 * Across alpha all stretches add u a_j, which sums to 0 with the goal's. */
static double along(const Problem *p, const Stretch *s, double angle, double *slope)
{
    double u = p->most * sin(angle), onward = p->most * cos(angle);
    int limits = s->limit <= p->most * (1 + 1e-12);
    if (s->straight < 0) {
        if (limits) {
            *slope = -s->size * sin(angle);
            return s->size * cos(angle);
        }
        double value = sqrt(MAX(0.0, s->size * s->size - s->a * s->a * u * u));
        *slope = s->a == 0 ? 0 : -s->a * s->a * u / value * onward;
        return value;
    }
    double share = u / s->speed, c = limits ? cos(angle) : sqrt(1 - share * share);
    double number = s->turned + s->a * u * share;
    *slope = -onward * (2 * s->a * share / c + number * share / (s->speed * c * c * c));
    return -number / c;
}

static double sum(const Problem *p, const double *signs, double angle, double *slope)
{
    double total = -p->row->tolerance, one;
    *slope = 0;
    for (int j = 0; j <= p->free; j++) {
        total += signs[j] * along(p, &p->stretch[j], angle, &one);
        *slope += signs[j] * one;
    }
    return total;
}

static void found(const Problem *p, const double *signs, double angle)
{
    Point point;
    point.u = p->most * sin(angle);
    for (int j = 0; j <= p->free; j++) {
        const Stretch *s = &p->stretch[j];
        double c = s->limit <= p->most * (1 + 1e-12) ? signs[j] * cos(angle) : root_of(point.u / s->limit, signs[j]);
        add(s, point.u, c, &point, j);
    }
    point.alpha = conj(point.chi[p->free]);
    take(p, &point);
}

/* The root between two angles whose values differ in sign: Newton, kept in by bisection. */
static void refine(const Problem *p, const double *signs, double low, double high, double f_low)
{
    double angle = 0.5 * (low + high), slope;
    for (int round = 0; round < 60; round++) {
        double f = sum(p, signs, angle, &slope), next = angle - f / slope;
        if ((f > 0) == (f_low > 0)) low = angle; else high = angle;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        double step = fabs(next - angle);
        angle = next;
        if (step < 1e-11) break;
    }
    found(p, signs, angle);
}

/* Between two angles of one sign with the nearest to 0 between them: two roots, if that is beyond 0. */
static void dip(const Problem *p, const double *signs, double low, double high, double sign)
{
    double slope, first = low, last = high;
    for (int round = 0; round < 40 && high - low > 1e-9; round++) {
        double angle = 0.5 * (low + high), f = sum(p, signs, angle, &slope);
        if (f * sign <= 0) {
            refine(p, signs, first, angle, sign);
            refine(p, signs, angle, last, -sign);
            return;
        }
        if (slope * sign < 0) low = angle; else high = angle;
    }
}

static int grid(const Problem *p, double *angles)
{
    static const double near[] = {1.5e-2, 2e-3, 2e-4, 1e-5};
    int count = 0, pole = 0;
    for (int j = 0; j <= p->free; j++)
        pole |= p->stretch[j].straight >= 0 && p->stretch[j].limit <= p->most * (1 + 1e-12);
    for (int i = 0; i < INTERVALS + !pole; i++) angles[count++] = MAX(1e-6, i * M_PI_2 / INTERVALS);
    for (int k = 0; pole && k < 4; k++) angles[count++] = M_PI_2 - near[k];
    return count;
}

/* Points along a curve, looked at when they are needed: what each stretch adds there, how that changes, and its
 * heading seen from alpha with the sign - and +. */
typedef struct {
    int count;
    char known[INTERVALS + 5];
    double angles[INTERVALS + 5], values[MOST + 2][INTERVALS + 5], slopes[MOST + 2][INTERVALS + 5];
    double aside[MOST + 2], chi[MOST + 2][2][INTERVALS + 5];
} Samples;

static void look(const Problem *p, Samples *s, int i)
{
    if (s->known[i]) return;
    s->known[i] = 1;
    double u = p->most * sin(s->angles[i]);
    for (int j = 0; j <= p->free; j++) {
        const Stretch *one = &p->stretch[j];
        s->values[j][i] = along(p, one, s->angles[i], &s->slopes[j][i]);
        if (one->straight < 0) {
            double bent = one->size > 0 ? asin(MAX(-1, MIN(1, u * one->a / one->size))) : 0;
            s->chi[j][1][i] = bent - s->aside[j];
            s->chi[j][0][i] = M_PI - bent - s->aside[j];
        } else {
            double bent = M_PI_2 + asin(MIN(1, u / one->speed));
            s->chi[j][1][i] = bent - s->aside[j];
            s->chi[j][0][i] = -bent - s->aside[j];
        }
    }
}

/* The least seconds of the turn from one heading to another, both monotone between two points of a curve. */
static double least_turn(double rate, double from, double from_end, double to, double to_end)
{
    double low = MIN(to, to_end) - MAX(from, from_end), high = MAX(to, to_end) - MIN(from, from_end);
    if (rate < 0) { double swap = -low; low = -high; high = swap; }
    low -= 1e-6;
    double rest = off_turns(low);
    if (rest < 0) rest += 2 * M_PI;
    return rest + (high + 1e-6 - low) >= 2 * M_PI ? 0 : rest / fabs(rate);
}

/* Seconds that the turns may take; straight lines that stand for slow turns take another time than they will. */
static double allowed(const Problem *p) { return p->on->slow ? INFINITY : p->row->best - p->row->fixed; }

/* Whether the turns take longer than allowed everywhere between two points of a curve. */
static int too_long(const Problem *p, unsigned choice, const Samples *s, int i, int k)
{
    double spent = 0, most = allowed(p);
    for (int j = 0; j <= p->free; j++) {
        const double *to = s->chi[j][(choice >> j) & 1];
        /* The goal's own heading is -alpha, and what is fixed is seen from alpha through it. */
        int before = j ? j - 1 : p->free;
        const double *from = s->chi[before][(choice >> before) & 1];
        if (j < p->free) spent += least_turn(p->stretch[j].rate, from[i], from[k], to[i], to[k]);
        else if (p->last_rate != 0)
            spent += least_turn(p->last_rate, from[i], from[k], p->on->target + to[i], p->on->target + to[k]);
        if (!(spent < most)) return 1;
    }
    return 0;
}

/* Whether the sum has one sign between two points: what a stretch adds is monotone, if its slope has one sign. */
static int one_sign(const Problem *p, unsigned choice, const Samples *s, int i, int k)
{
    double low = -p->row->tolerance, high = low;
    for (int j = 0; j <= p->free; j++) {
        double first = s->values[j][i], last = s->values[j][k];
        if (p->stretch[j].straight >= 0 && !(s->slopes[j][i] * s->slopes[j][k] > 0)) return 0;
        if (!((choice >> j) & 1)) { first = -first; last = -last; }
        low += MIN(first, last);
        high += MAX(first, last);
    }
    return low > 1e-9 || high < -1e-9;
}

/* All roots between two points with one choice of signs. */
static void follow(const Problem *p, unsigned choice, Samples *s, int i, int k)
{
    look(p, s, i);
    look(p, s, k);
    if (one_sign(p, choice, s, i, k) || too_long(p, choice, s, i, k)) return;
    if (k - i > 1) {
        follow(p, choice, s, i, (i + k) / 2);
        follow(p, choice, s, (i + k) / 2, k);
        return;
    }
    double signs[MOST + 2], before = -p->row->tolerance, after = before, left = 0, right = 0;
    for (int j = 0; j <= p->free; j++) {
        signs[j] = (choice >> j) & 1 ? 1 : -1;
        before += signs[j] * s->values[j][i];
        after += signs[j] * s->values[j][k];
        left += signs[j] * s->slopes[j][i];
        right += signs[j] * s->slopes[j][k];
    }
    if ((before > 0) != (after > 0)) {
        refine(p, signs, s->angles[i], s->angles[k], before);
        return;
    }
    double sign = before > 0 ? 1 : -1;
    if (!(left * sign < 0 && right * sign > 0)) return;
    /* Where the tangents meet is beyond the curve, unless it bends twice. */
    double width = s->angles[k] - s->angles[i];
    double meet = (after - before - right * width) / (left - right);
    if ((before + left * meet) * sign > 0.5 * MIN(before * sign, after * sign)) return;
    dip(p, signs, s->angles[i], s->angles[k], sign);
}

/* The end of a curve at which a straight coast runs exactly along alpha: there, and so near that no sample is
 * between, its time is what closes the way. (So it is where a turn leads into a straight line at equal speed.) */
static void at_the_end(const Problem *p, unsigned choice)
{
    int last = -1;
    for (int j = 0; j <= p->free; j++)
        if (p->stretch[j].straight >= 0 && p->stretch[j].limit <= p->most * (1 + 1e-12)) {
            if (last >= 0) return;
            last = j;
        }
    if (last < 0 || (choice >> last) & 1) return;
    Point point = {.u = p->most};
    double way = -p->row->tolerance;
    for (int j = 0; j <= p->free; j++)
        if (j != last) {
            const Stretch *s = &p->stretch[j];
            way += creal(add(s, point.u, root_of(point.u / s->limit, (choice >> j) & 1 ? 1.0 : -1.0), &point, j));
        }
    const Stretch *s = &p->stretch[last];
    point.chi[last] = -conj(s->w) / s->speed;
    point.straight[s->straight] = (way + creal(point.chi[last] * s->A)) / s->speed;
    point.alpha = conj(point.chi[p->free]);
    take(p, &point);
}

/* Every choice of signs. Two equations can hold no more than two directions in which the cost curves down: each
 * plain stretch with the sign + has one, each with a straight coast has one. */
static void all_curves(Problem *p)
{
    Stretch *goal = &p->stretch[p->free];
    *goal = (Stretch){.A = -p->rest, .size = cabs(p->rest), .straight = -1, .other = -1};
    for (int j = 0; j < p->free; j++) goal->a -= p->stretch[j].a;
    goal->limit = goal->a != 0 ? goal->size / fabs(goal->a) : INFINITY;
    if (p->fixed) {
        goal->straight = p->fixed_place[0];
        goal->w = p->fixed_velocity[0];
        goal->limit = goal->speed = cabs(goal->w);
    }
    p->most = INFINITY;
    int straight = 0;
    for (int j = 0; j <= p->free; j++) {
        Stretch *s = &p->stretch[j];
        p->most = MIN(p->most, s->limit);
        if (s->straight >= 0) s->turned = cimag(s->A * conj(s->w)) / s->speed;
        straight += s->straight >= 0 && j < p->free;
    }
    if (!(p->most > 1e-9 && p->most < INFINITY) || straight > 2) return;
    Samples samples;
    samples.count = grid(p, samples.angles);
    memset(samples.known, 0, sizeof(samples.known));
    for (int j = 0; j <= p->free; j++)
        samples.aside[j] = carg(p->stretch[j].straight < 0 ? p->stretch[j].A : p->stretch[j].w);
    for (unsigned choice = 0; choice < 2u << p->free; choice++) {
        int curved = straight;
        for (int j = 0; j < p->free; j++) curved += ((choice >> j) & 1) && p->stretch[j].straight < 0;
        if (curved > 2) continue;
        follow(p, choice, &samples, 0, samples.count - 1);
        at_the_end(p, choice);
    }
}
