/* Curves of candidates: all choices of signs of the one equation. */
#include "coasting.h"

#define INTERVALS 16      /* samples along a curve */
#define SLACK_OF_SUMS 1e-15 /* of the first terms of a sum: its rounding */
#define SAME_LIMIT 1e-12  /* of a limit: closer ones are equal */

/* Samples along a curve, computed when needed: contribution of each stretch, its slope with a straight coast, and its
 * heading seen from alpha for the signs - and +. */
typedef struct {
    int count;
    char known[INTERVALS + 5];
    double at[INTERVALS + 5], values[MOST + 2][INTERVALS + 5], slopes[MOST + 2][INTERVALS + 5];
    double chi[MOST + 2][2][INTERVALS + 5];
} Samples;

/* Whether a straight coast's time has a pole at the end of the curve, where the coast runs exactly along alpha. */
static int has_pole(const Chain *c, const Stretch *s)
{
    return s->straight >= 0 && s->limit <= c->most * (1 + SAME_LIMIT);
}

static void init_samples(const Chain *c, Samples *s)
{
    /* Cosines of equal steps up to a right angle, from u = 0 (the goal at the edge of reach). */
    static const double steps[INTERVALS] = {
        1.0, 0.9951847266721969, 0.9807852804032304, 0.9569403357322088,
        0.9238795325112867, 0.881921264348355, 0.8314696123025452, 0.773010453362737,
        0.7071067811865476, 0.6343932841636455, 0.5555702330196023, 0.4713967368259978,
        0.38268343236508984, 0.29028467725446233, 0.19509032201612833, 0.09801714032956077};
    static const double near[] = {1.5e-2, 2e-3, 2e-4, 1e-5};
    int pole = 0;
    s->count = 0;
    for (int j = 0; j <= c->free; j++) pole |= has_pole(c, &c->stretch[j]);
    for (int i = 0; i < INTERVALS; i++) s->at[s->count++] = c->most * steps[i];
    if (!pole) s->at[s->count++] = 0;
    for (int k = 0; pole && k < 4; k++) s->at[s->count++] = c->most * near[k];
    memset(s->known, 0, sizeof(s->known));
}

static void sample(const Chain *c, Samples *s, int i)
{
    if (s->known[i]) return;
    s->known[i] = 1;
    double u = across(c, s->at[i]);
    for (int j = 0; j <= c->free; j++) {
        const Stretch *one = &c->stretch[j];
        double E = E_of(one, s->at[i]), plus = heading_of(one, u, E, 1);
        s->values[j][i] = along(one, E);
        if (one->straight >= 0) s->slopes[j][i] = slope_of(one, E, s->at[i]);
        s->chi[j][1][i] = plus;
        s->chi[j][0][i] = (one->straight < 0 ? PI : 0) - plus - 2 * one->aside;
    }
}

/* Whether the turns exceed the seconds left everywhere between two samples. */
static int too_long(const Chain *c, unsigned choice, const Samples *s, int i, int k)
{
    double from[MOST + 2], to[MOST + 2];
    for (int j = 0; j <= c->free; j++) {
        const double *chi = s->chi[j][(choice >> j) & 1];
        from[j] = chi[i];
        to[j] = chi[k];
    }
    return turns_too_long(c, from, to);
}

/* Whether the sum has one sign between two samples; contributions with slopes of one sign are monotone. */
static int one_sign(const Chain *c, unsigned choice, const Samples *s, int i, int k)
{
    double low = -c->problem->tolerance, high = low, size = 0;
    for (int j = 0; j <= c->free; j++) {
        double first = s->values[j][i], last = s->values[j][k];
        if (c->stretch[j].straight >= 0 && !(s->slopes[j][i] * s->slopes[j][k] > 0)) return 0;
        if (!((choice >> j) & 1)) {
            first = -first;
            last = -last;
        }
        low += lesser(first, last);
        high += greater(first, last);
        size += fabs(first);
    }
    double slack = c->problem->slack + SLACK_OF_SUMS * size;
    return low > slack || high < -slack;
}

/* Finds all roots between two samples for one choice of signs. */
static void follow(const Chain *c, unsigned choice, Samples *s, int i, int k)
{
    sample(c, s, i);
    sample(c, s, k);
    if (one_sign(c, choice, s, i, k) || too_long(c, choice, s, i, k)) return;
    if (k - i > 1) {
        follow(c, choice, s, i, (i + k) / 2);
        follow(c, choice, s, (i + k) / 2, k);
        return;
    }
    double signs[MOST + 2];
    for (int j = 0; j <= c->free; j++) signs[j] = (choice >> j) & 1 ? 1 : -1;
    isolate(c, signs, s->at[k], s->at[i], 0);
}

/* The end of a curve with a pole: there the time of the straight coast is what closes the chain. (The case of a turn
 * into a straight line at equal speed.) */
static void at_the_end(const Chain *c, unsigned choice)
{
    int last = -1;
    for (int j = 0; j <= c->free; j++)
        if (has_pole(c, &c->stretch[j])) {
            /* Two coasts along alpha are interchangeable: one is enough. */
            if (last >= 0) return;
            last = j;
        }
    if (last < 0 || (choice >> last) & 1) return;
    Point point = {.u = c->most};
    double way = -c->problem->tolerance;
    for (int j = 0; j <= c->free; j++)
        if (j != last) {
            const Stretch *s = &c->stretch[j];
            double root = s->limit < INFINITY ? sqrt(s->above) / s->limit : 1;
            way += creal(add(s, point.u, (choice >> j) & 1 ? root : -root, &point, j));
        }
    const Stretch *s = &c->stretch[last];
    point.chi[last] = -conj(s->w) / s->speed;
    point.straight[s->straight] = (way + creal(point.chi[last] * s->A)) / s->speed;
    point.alpha = conj(point.chi[c->free]);
    set_headings(c, &point);
}

/* Adds the goal as a stretch that closes the chain, and relates all limits to the least one; returns 0 where there is
 * none. */
static int close_way(Chain *c)
{
    Stretch *goal = &c->stretch[c->free];
    *goal = (Stretch){.A = -c->rest, .size = cabs(c->rest), .straight = -1};
    for (int j = 0; j < c->free; j++) goal->a -= c->stretch[j].a;
    goal->limit = goal->size / fabs(goal->a);
    if (!(goal->limit < LIMITLESS)) {
        goal->a = 0;
        goal->limit = INFINITY;
    }
    if (c->fixed) {
        goal->straight = c->fixed_place[0];
        goal->w = c->fixed_velocity[0];
        goal->limit = goal->speed = cabs(goal->w);
    }
    c->most = INFINITY;
    for (int j = 0; j <= c->free; j++) {
        Stretch *s = &c->stretch[j];
        c->most = lesser(c->most, s->limit);
        if (s->straight >= 0) s->K = cimag(s->A * conj(s->w)) + s->a * s->speed * s->speed;
        s->aside = carg(s->straight < 0 ? s->A : s->w);
    }
    for (int j = 0; j <= c->free; j++) {
        Stretch *s = &c->stretch[j];
        s->above = s->limit < INFINITY ? (s->limit - c->most) * (s->limit + c->most) : 0;
    }
    return c->most > 0 && c->most < INFINITY;
}

/* Whether a choice of signs can be a minimum. Two equations admit at most two directions of negative curvature: each
 * stretch with the sign + and no straight coast has one, and each straight coast takes one equation. */
static int can_be_least(const Chain *c, unsigned choice)
{
    int curved = c->straights;
    for (int j = 0; j < c->free; j++) curved += ((choice >> j) & 1) && c->stretch[j].straight < 0;
    return curved <= 2;
}

/* Finds the candidates of every choice of signs. */
void all_curves(Chain *c)
{
    Samples samples;
    if (!close_way(c)) return;
    init_samples(c, &samples);
    for (unsigned choice = 0; choice < 2u << c->free; choice++) {
        if (!can_be_least(c, choice)) continue;
        follow(c, choice, &samples, 0, samples.count - 1);
        at_the_end(c, choice);
    }
}
