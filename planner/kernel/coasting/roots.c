/* All roots of the one equation between two points of a curve, for one choice of signs.
 *
 * The terms of slow turns are as long as their radii and cancel almost completely: what remains may be a millionth of
 * them. Bounds term by term would need millions of pieces. So the sum is expanded about the middle of a piece to the
 * third power of s, and only the remainder is bounded term by term. A piece is halved until the expansion shows that
 * it has no root or is monotone. A sum that touches 0, or ends at it, to within the slack counts as a root: the goal
 * is at the edge of reach. A sum that is 0 throughout, as with maneuvers without displacement, is a family of times of
 * one cost, of which its two ends are taken.
 */
#include "coasting.h"

#define ROUNDING 1e-15    /* of the largest term of a sum */
#define MOST_HALVED 60    /* halvings of a piece */
#define TOLD_APART 0.1    /* of the slack; smaller variation is none */
#define REFINED 80        /* rounds of refinement ... */
#define ROOT_ROUNDING 1e-12 /* ... and of s: smaller steps are rounding */

typedef struct { double value, slope, second, third, fourth, size; } Series;  /* fourth, size: bounds */

static void expand(Series *t, double weight, double inverse, double above, double s, double low)
{
    double E = sqrt(above + s * s), w = 1 / E, w2 = w * w, x = s * w, h = above * w2;
    double least = above + low * low, bound = lesser(3, 12 * above / least) * fabs(weight);
    if (above == 0) {
        t->value += weight * s;
        t->slope += weight;
        t->size += fabs(weight) * s;
        bound = 0;
    } else {
        t->value += weight * E;
        t->slope += weight * x;
        t->second += weight * h * w;
        t->third -= 3 * weight * h * x * w2;
        t->size += fabs(weight) * E;
        bound /= least * sqrt(least);
    }
    if (inverse != 0) {
        t->value += inverse * w;
        t->slope -= inverse * x * w2;
        t->second += inverse * (3 * x * x - 1) * w * w2;
        t->third += inverse * x * (9 - 15 * x * x) * w2 * w2;
        t->size += fabs(inverse) * w;
        bound += 24 * fabs(inverse) / (least * least * sqrt(least));
    }
    t->fourth += bound;
}

/* Expands the sum at s; bounds hold from low to as far on the other side. */
static Series series(const Chain *c, const double *signs, double s, double low)
{
    Series t = {.value = -c->problem->tolerance, .size = c->problem->tolerance};
    for (int j = 0; j <= c->free; j++) {
        const Stretch *one = &c->stretch[j];
        if (one->straight >= 0) expand(&t, signs[j] * one->a, -signs[j] * one->K, one->above, s, low);
        else if (one->a != 0) expand(&t, signs[j] * fabs(one->a), 0, one->above, s, low);
        else {
            t.value += signs[j] * one->size;
            t.size += one->size;
        }
    }
    return t;
}

static double sum(const Chain *c, const double *signs, double s, double *slope)
{
    double total = -c->problem->tolerance;
    *slope = 0;
    for (int j = 0; j <= c->free; j++) {
        double E = E_of(&c->stretch[j], s);
        total += signs[j] * along(&c->stretch[j], E);
        *slope += signs[j] * slope_of(&c->stretch[j], E, s);
    }
    return total;
}

/* Refines the root between two points of different signs: Newton's method, safeguarded by bisection. */
static void refine(const Chain *c, const double *signs, double low, double high, double f_low)
{
    double s = 0.5 * (low + high), slope;
    for (int round = 0; round < REFINED; round++) {
        double f = sum(c, signs, s, &slope), next = s - f / slope;
        if ((f > 0) == (f_low > 0)) low = s; else high = s;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        double step = fabs(next - s);
        s = next;
        if (step <= ROOT_ROUNDING * s) break;
    }
    emit_times(c, signs, s);
}

static int piece_too_long(const Chain *c, const double *signs, double low, double high)
{
    double from[MOST + 2], to[MOST + 2], u_low = across(c, low), u_high = across(c, high);
    for (int j = 0; j <= c->free; j++) {
        const Stretch *one = &c->stretch[j];
        from[j] = heading_of(one, u_low, E_of(one, low), signs[j] > 0);
        to[j] = heading_of(one, u_high, E_of(one, high), signs[j] > 0);
    }
    return turns_too_long(c, from, to);
}

/* Isolates the roots of a piece by halving. */
void isolate(const Chain *c, const double *signs, double low, double high, int halved)
{
    double s = 0.5 * (low + high), w = 0.5 * (high - low);
    Series t = series(c, signs, s, low);
    double rounding = ROUNDING * t.size, near = c->problem->slack + rounding;
    double bends = fabs(t.second) * w + 0.5 * fabs(t.third) * w * w + t.fourth * w * w * w / 6;
    if (!(fabs(t.value) <= fabs(t.slope) * w + bends * w + near)) return;
    if (halved && piece_too_long(c, signs, low, high)) return;
    double flat = TOLD_APART * c->problem->slack + rounding, slope;
    int monotone = bends < fabs(t.slope);
    int level = fabs(t.value) <= near && fabs(t.slope) * w <= flat && fabs(t.second) * w * w <= flat
        && fabs(t.third) * w * w * w <= flat;
    if (monotone || level) {
        double first = sum(c, signs, low, &slope), last = sum(c, signs, high, &slope);
        int crosses = monotone && (first > 0) != (last > 0);
        /* A sum that is flat in the middle may still vary towards the ends. */
        int done = monotone || (fabs(first) <= 2 * near && fabs(last) <= 2 * near);
        if (crosses) refine(c, signs, low, high, first);
        if (done && !crosses && fabs(first) <= near) emit_times(c, signs, low);
        if (done && !crosses && fabs(last) <= near) emit_times(c, signs, high);
        if (done) return;
    }
    if (halved > MOST_HALVED) return;
    isolate(c, signs, low, s, halved + 1);
    isolate(c, signs, s, high, halved + 1);
}
