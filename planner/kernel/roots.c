/* All roots of the one equation between two points of a curve, for one choice of signs.
 *
 * The terms of slow turns are as long as their radii and cancel almost wholly: what is left may be the millionth
 * part, and bends on a scale of its own. Bounds term by term would need millions of pieces. So the sum is expanded
 * about the middle of a piece to the third power of s, in which terms cancel as they do, and only what is beyond it is
 * bounded term by term. A piece is halved until the expansion shows that the sum has no root there, or is monotone.
 */
#include "stretches.c"

typedef struct { double value, slope, second, third, fourth, size; } Series;  /* fourth, size: bounds */

static void expand(Series *t, double weight, double inverse, double above, double s, double low)
{
    double E = sqrt(above + s * s), w = 1 / E, w2 = w * w, x = s * w, h = above * w2;
    double least = above + low * low, bound = MIN(3, 12 * above / least) * fabs(weight);
    if (above == 0) { t->value += weight * s; t->slope += weight; t->size += fabs(weight) * s; bound = 0; }
    else {
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

/* The sum at s, with bounds that hold down to low and as far up. */
static Series series(const Problem *p, const double *signs, double s, double low)
{
    Series t = {.value = -p->row->tolerance, .size = p->row->tolerance};
    for (int j = 0; j <= p->free; j++) {
        const Stretch *one = &p->stretch[j];
        if (one->straight >= 0) expand(&t, signs[j] * one->a, -signs[j] * one->K, one->above, s, low);
        else if (one->a != 0) expand(&t, signs[j] * fabs(one->a), 0, one->above, s, low);
        else { t.value += signs[j] * one->size; t.size += one->size; }
    }
    return t;
}

static double sum(const Problem *p, const double *signs, double s, double *slope)
{
    double total = -p->row->tolerance;
    *slope = 0;
    for (int j = 0; j <= p->free; j++) {
        double E = E_of(&p->stretch[j], s);
        total += signs[j] * along(&p->stretch[j], E);
        *slope += signs[j] * slope_of(&p->stretch[j], E, s);
    }
    return total;
}

/* The root between two points whose values differ in sign: Newton, kept in by bisection. */
static void refine(const Problem *p, const double *signs, double low, double high, double f_low)
{
    double s = 0.5 * (low + high), slope;
    for (int round = 0; round < 80; round++) {
        double f = sum(p, signs, s, &slope), next = s - f / slope;
        if ((f > 0) == (f_low > 0)) low = s; else high = s;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        double step = fabs(next - s);
        s = next;
        if (step <= 1e-12 * s) break;
    }
    found(p, signs, s);
}

static int piece_too_long(const Problem *p, const double *signs, double low, double high)
{
    double from[MOST + 2], to[MOST + 2], u_low = across(p, low), u_high = across(p, high);
    for (int j = 0; j <= p->free; j++) {
        const Stretch *one = &p->stretch[j];
        from[j] = heading_of(one, u_low, E_of(one, low), signs[j] > 0);
        to[j] = heading_of(one, u_high, E_of(one, high), signs[j] > 0);
    }
    return turns_too_long(p, from, to);
}

static void isolate(const Problem *p, const double *signs, double low, double high, int halved)
{
    double s = 0.5 * (low + high), w = 0.5 * (high - low);
    Series t = series(p, signs, s, low);
    /* Within the slack a sum that touches 0, or ends at it, counts as a root. */
    double rounding = ROUNDING * t.size, near = p->row->slack + rounding;
    double bends = fabs(t.second) * w + 0.5 * fabs(t.third) * w * w + t.fourth * w * w * w / 6;
    if (fabs(t.value) > fabs(t.slope) * w + bends * w + near) return;
    if (halved && piece_too_long(p, signs, low, high)) return;
    if (bends < fabs(t.slope)) {
        double slope, first = sum(p, signs, low, &slope), last = sum(p, signs, high, &slope);
        if ((first > 0) != (last > 0)) refine(p, signs, low, high, first);
        else if (fabs(first) <= near) found(p, signs, low);
        else if (fabs(last) <= near) found(p, signs, high);
        return;
    }
    /* What rounding hides is no further told apart. */
    if (fabs(t.slope) * w + bends * w <= TOLD_APART * near || halved > MOST_HALVED) { found(p, signs, s); return; }
    isolate(p, signs, low, s, halved + 1);
    isolate(p, signs, s, high, halved + 1);
}
