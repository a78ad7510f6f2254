/* What one stretch adds to the way, and its heading, as functions of u: see times.c.
 *
 * Along a curve u runs from 0 to `most`, the least of the stretches' limits. A slow turn that flies nearly straight
 * at the goal stands a hair below its limit, where u itself tells nothing any more. So curves run along
 * s = sqrt(most^2 - u^2), and a stretch knows by how much its own limit exceeds the least one:
 *
 *     E = sqrt(limit^2 - u^2) = sqrt(above + s^2),   above = limit^2 - most^2.
 *
 * A stretch without a straight coast adds |a| E along alpha, one with a straight coast a E - K / E.
 */
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
static double across(const Problem *p, double s) { return sqrt(MAX(0.0, (p->most - s) * (p->most + s))); }

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
    /* At the edge of reach no multiplier is finite, and to turns that share a heading the goal is worth nothing. */
    int worth = point->u > 0 && !p->on->shared;
    from_headings(p->row, p->on, heading, point->straight, worth ? alpha / point->u : 0);
}

static double E_of(const Stretch *one, double s) { return sqrt(one->above + s * s); }

/* What a stretch adds along alpha, but for its sign. Across alpha all stretches add u a_j, which sums to 0 with the
 * goal's. */
static double along(const Stretch *one, double E)
{
    if (one->straight >= 0) return one->a * E - one->K / E;
    return one->a == 0 ? one->size : fabs(one->a) * E;
}

/* How that changes with s. */
static double slope_of(const Stretch *one, double E, double s)
{
    double rises = E > 0 ? s / E : 1;
    if (one->straight >= 0) return (one->a + one->K / (E * E)) * rises;
    return fabs(one->a) * rises;
}

/* The heading of a stretch, seen from alpha, with the sign +; with the sign - it is mirrored. */
static double heading_of(const Stretch *one, double u, double E, int plus)
{
    /* Near the limit E tells it, u does not. */
    double share = u / one->limit, bent = share < 0.9 ? asin(share) : acos(MIN(1, E / one->limit));
    if (one->straight >= 0) {
        bent += M_PI_2;
        return (plus ? bent : -bent) - one->aside;
    }
    if (one->a < 0) bent = -bent;
    return (plus ? bent : M_PI - bent) - one->aside;
}

/* The times that belong to a point of a curve. */
static void found(const Problem *p, const double *signs, double s)
{
    Point point = {.u = across(p, s)};
    for (int j = 0; j <= p->free; j++) {
        const Stretch *one = &p->stretch[j];
        double c = one->limit < INFINITY ? sqrt(one->above + s * s) / one->limit : 1;
        add(one, point.u, signs[j] * c, &point, j);
    }
    point.alpha = conj(point.chi[p->free]);
    take(p, &point);
}

/* The least seconds of the turn from one heading to another, both monotone between two points of a curve. */
static double least_turn(double rate, double from, double from_end, double to, double to_end)
{
    double low = MIN(to, to_end) - MAX(from, from_end), high = MAX(to, to_end) - MIN(from, from_end);
    if (rate < 0) { double swap = -low; low = -high; high = swap; }
    low -= BLUR;
    double rest = off_turns(low);
    if (rest < 0) rest += 2 * M_PI;
    return rest + (high + BLUR - low) >= 2 * M_PI ? 0 : rest / fabs(rate);
}

/* Seconds that the turns may take; straight lines that stand for slow turns take another time than they will. */
static double allowed(const Problem *p) { return p->on->slow ? INFINITY : p->row->best - p->row->fixed; }

/* Whether the turns take longer than allowed everywhere between two points of a curve, whose headings are given. */
static int turns_too_long(const Problem *p, const double *from, const double *to)
{
    double spent = 0, most = allowed(p);
    for (int j = 0; j <= p->free; j++) {
        /* The goal's own heading is -alpha, and what is fixed is seen from alpha through it. */
        int before = j ? j - 1 : p->free;
        if (j < p->free) spent += least_turn(p->stretch[j].rate, from[before], to[before], from[j], to[j]);
        else if (p->last_rate != 0)
            spent += least_turn(p->last_rate, from[before], to[before], p->on->target + from[j],
                                p->on->target + to[j]);
        if (!(spent < most)) return 1;
    }
    return 0;
}
