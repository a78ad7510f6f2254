/* The curves of candidates: every choice of signs of the one equation, see times.c. */
#include "roots.c"

/* Points along a curve, looked at when they are needed: what each stretch adds there, how that changes with a
 * straight coast, and its heading seen from alpha with the sign - and +. */
typedef struct {
    int count;
    char known[INTERVALS + 5];
    double at[INTERVALS + 5], values[MOST + 2][INTERVALS + 5], slopes[MOST + 2][INTERVALS + 5];
    double chi[MOST + 2][2][INTERVALS + 5];
} Samples;

/* At the end of a curve at which a straight coast runs exactly along alpha its time has a pole. */
static int has_pole(const Problem *p, const Stretch *s)
{
    return s->straight >= 0 && s->limit <= p->most * (1 + 1e-12);
}

static void lay(const Problem *p, Samples *s)
{
    /* Cosines of equal steps up to a right angle: from u = 0, where the goal is at the edge of reach. */
    static const double steps[INTERVALS] = {
        1.0, 0.9951847266721969, 0.9807852804032304, 0.9569403357322088,
        0.9238795325112867, 0.881921264348355, 0.8314696123025452, 0.773010453362737,
        0.7071067811865476, 0.6343932841636455, 0.5555702330196023, 0.4713967368259978,
        0.38268343236508984, 0.29028467725446233, 0.19509032201612833, 0.09801714032956077};
    static const double near[] = {1.5e-2, 2e-3, 2e-4, 1e-5};
    int pole = 0;
    s->count = 0;
    for (int j = 0; j <= p->free; j++) pole |= has_pole(p, &p->stretch[j]);
    for (int i = 0; i < INTERVALS; i++) s->at[s->count++] = p->most * steps[i];
    if (!pole) s->at[s->count++] = 0;
    for (int k = 0; pole && k < 4; k++) s->at[s->count++] = p->most * near[k];
    memset(s->known, 0, sizeof(s->known));
}

static void look(const Problem *p, Samples *s, int i)
{
    if (s->known[i]) return;
    s->known[i] = 1;
    double u = across(p, s->at[i]);
    for (int j = 0; j <= p->free; j++) {
        const Stretch *one = &p->stretch[j];
        double E = E_of(one, s->at[i]), turned = heading_of(one, u, E, 1);
        s->values[j][i] = along(one, E);
        if (one->straight >= 0) s->slopes[j][i] = slope_of(one, E, s->at[i]);
        s->chi[j][1][i] = turned;
        s->chi[j][0][i] = (one->straight < 0 ? M_PI : 0) - turned - 2 * one->aside;
    }
}

/* Whether the turns take longer than allowed everywhere between two points of a curve. */
static int too_long(const Problem *p, unsigned choice, const Samples *s, int i, int k)
{
    double from[MOST + 2], to[MOST + 2];
    for (int j = 0; j <= p->free; j++) {
        const double *chi = s->chi[j][(choice >> j) & 1];
        from[j] = chi[i];
        to[j] = chi[k];
    }
    return turns_too_long(p, from, to);
}

/* Whether the sum has one sign between two points: what a stretch adds is monotone, if its slope has one sign. */
static int one_sign(const Problem *p, unsigned choice, const Samples *s, int i, int k)
{
    double low = -p->row->tolerance, high = low, size = 0;
    for (int j = 0; j <= p->free; j++) {
        double first = s->values[j][i], last = s->values[j][k];
        if (p->stretch[j].straight >= 0 && !(s->slopes[j][i] * s->slopes[j][k] > 0)) return 0;
        if (!((choice >> j) & 1)) { first = -first; last = -last; }
        low += MIN(first, last);
        high += MAX(first, last);
        size += fabs(first);
    }
    double slack = p->row->slack + ROUNDING * size;
    return low > slack || high < -slack;
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
    double signs[MOST + 2];
    for (int j = 0; j <= p->free; j++) signs[j] = (choice >> j) & 1 ? 1 : -1;
    isolate(p, signs, s->at[k], s->at[i], 0);
}

/* The end of a curve at which a straight coast runs exactly along alpha: there, and so near that no sample is
 * between, its time is what closes the way. (So it is where a turn leads into a straight line at equal speed.) */
static void at_the_end(const Problem *p, unsigned choice)
{
    int last = -1;
    for (int j = 0; j <= p->free; j++)
        if (has_pole(p, &p->stretch[j])) {
            if (last >= 0) return;
            last = j;
        }
    if (last < 0 || (choice >> last) & 1) return;
    Point point = {.u = p->most};
    double way = -p->row->tolerance;
    for (int j = 0; j <= p->free; j++)
        if (j != last) {
            const Stretch *s = &p->stretch[j];
            double c = s->limit < INFINITY ? sqrt(s->above) / s->limit : 1;
            way += creal(add(s, point.u, (choice >> j) & 1 ? c : -c, &point, j));
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
    goal->limit = goal->size / fabs(goal->a);
    if (!(goal->limit < 1e100)) { goal->a = 0; goal->limit = INFINITY; }
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
        if (s->straight >= 0) s->K = cimag(s->A * conj(s->w)) + s->a * s->speed * s->speed;
        s->aside = carg(s->straight < 0 ? s->A : s->w);
        straight += s->straight >= 0 && j < p->free;
    }
    if (!(p->most > 1e-9 && p->most < INFINITY) || straight > 2) return;
    for (int j = 0; j <= p->free; j++) {
        Stretch *s = &p->stretch[j];
        s->above = s->limit < INFINITY ? (s->limit - p->most) * (s->limit + p->most) : 0;
    }
    Samples samples;
    lay(p, &samples);
    for (unsigned choice = 0; choice < 2u << p->free; choice++) {
        int curved = straight;
        for (int j = 0; j < p->free; j++) curved += ((choice >> j) & 1) && p->stretch[j].straight < 0;
        if (curved > 2) continue;
        follow(p, choice, &samples, 0, samples.count - 1);
        at_the_end(p, choice);
    }
}
