/* A bound of a walk's seconds that is nearly sharp: weak duality, the headings chosen by dynamic programming.
 *
 * For any vector m (s/m), no plan that ends within the tolerance of the goal takes less than the least of
 *
 *     seconds + dot(m, end - goal) - |m| tolerance
 *
 * over all coasting times. That is a sum over stretches (times.c) of
 *
 *     a_j psi_j + dot(m, exp(i psi_j) A_j) + straight coasts' min(0, t (1 + dot(m, exp(i psi_j) W))), t the most seconds,
 *
 * with a_j = 1/r_j - 1/r_(j+1), in which two neighbours are bound by nothing but the side that the turn between
 * them turns to. So the least is found from stretch to stretch, as a function of the heading on a grid. Between
 * two angles of it a function lies below the line through its values by no more than its second derivative
 * times the square of the step over 8, and the least value so far, and the lesser of such a line and 0, lie above
 * the lines through theirs: the bound holds between the angles, too.
 */
#include "bounds.c"

#define GRID 128          /* angles in a turn, at the finest */
#define COARSEST 4        /* of them make the largest step */
#define ENOUGH 40         /* angles: with more the step is doubled */
#define ANGLES 160        /* most of them */
#define OTHER_TURNS 8     /* full turns by which wanted headings may differ */
#define FORBIDDEN 1e9     /* s */
#define TOO_LONG 1e4      /* s/m */
#define ROUNDS 8

typedef struct { double low, high; } Range;

typedef struct {
    int stretches, straights[MOST + 1];
    cplx A[MOST + 1], W[MOST + 1][MOST];
    double a[MOST + 1], rate[MOST + 1];   /* of the turn after the stretch; 0 after the last */
    double seconds;                       /* that coasts may take */
    double step;                          /* rad between angles */
    int left, angles;                     /* those to the left of heading 0; all */
    double cosine[ANGLES], sine[ANGLES];
    int wants_heading, wanted_ranges;
    Range wanted[OTHER_TURNS];
} Chain;

static double length(cplx z) { return sqrt(creal(z) * creal(z) + cimag(z) * cimag(z)); }

/* The angles that coasts can turn to in the seconds; 0 if they are too many. */
static int lay_grid(Chain *c, double left, double right)
{
    static const double finest = 2 * M_PI / GRID;
    double reach = (left + right) * c->seconds;
    int stride = 1;
    while (stride < COARSEST && reach > finest * stride * ENOUGH) stride *= 2;
    c->step = finest * stride;
    if (!(reach < c->step * (ANGLES - 5))) return 0;
    c->left = (int)ceil(left * c->seconds / c->step) + 1;
    c->angles = c->left + (int)ceil(right * c->seconds / c->step) + 2;
    cplx factor = turned(-c->left * c->step), onward = turned(c->step);
    for (int i = 0; i < c->angles; i++, factor *= onward) {
        c->cosine[i] = creal(factor);
        c->sine[i] = cimag(factor);
    }
    return 1;
}

/* The parts of the grid where the heading at the end is as wanted; 0 if they are too many. */
static int find_wanted(Chain *c, const Row *row)
{
    double slack = row->heading_tolerance + row->heading_slack;
    c->wants_heading = row->wants_heading && slack < M_PI;
    c->wanted_ranges = 0;
    if (!c->wants_heading) return 1;
    double least = -c->left * c->step, most = (c->angles - 1 - c->left) * c->step;
    double first = ceil((least - slack - row->heading) / (2 * M_PI));
    double last = floor((most + slack - row->heading) / (2 * M_PI));
    for (double turns = first; turns <= last; turns++) {
        if (c->wanted_ranges == OTHER_TURNS) return 0;
        double middle = row->heading + 2 * M_PI * turns;
        c->wanted[c->wanted_ranges++] = (Range){MAX(least, middle - slack), MIN(most, middle + slack)};
    }
    return 1;
}

/* The stretches that a set of times makes; 0 where turns are too slow or headings too many for a grid. */
static int make_chain(Chain *c, const Row *row, unsigned mask, double seconds)
{
    int j = 0;
    double right = 0, left = 0, before = 0;
    c->A[0] = 0;
    c->straights[0] = 0;
    for (int k = 0; k < row->trims; k++) {
        double rate = row->rate[k];
        c->A[j] += row->D[k];
        if (!((mask >> k) & 1)) continue;
        if (rate == 0) { c->W[j][c->straights[j]++] = row->W[k]; continue; }
        if (fabs(rate) <= 1e-4) return 0;
        c->A[j] -= row->C[k];
        c->a[j] = before - 1 / rate;
        c->rate[j] = rate;
        before = 1 / rate;
        right = MAX(right, rate);
        left = MAX(left, -rate);
        c->A[++j] = row->C[k];
        c->straights[j] = 0;
    }
    c->a[j] = before;
    c->rate[j] = 0;
    c->stretches = j + 1;
    c->seconds = seconds;
    return lay_grid(c, left, right) && find_wanted(c, row);
}

/* Adds what a stretch costs at every angle; returns what a line between two angles may hide, in steps squared / 8. */
static double add_stretch(const Chain *c, int j, cplx m, double *f)
{
    double x = dot(m, c->A[j]), y = dot(m, I * c->A[j]), slope = c->a[j] * c->step, hidden = length(c->A[j]);
    for (int i = 0; i < c->angles; i++)
        f[i] += slope * (i - c->left) + x * c->cosine[i] + y * c->sine[i];
    for (int s = 0; s < c->straights[j]; s++) {
        cplx way = c->seconds * c->W[j][s];
        double along = dot(m, way), aside = dot(m, I * way);
        hidden += length(way);
        for (int i = 0; i < c->angles; i++)
            f[i] += MIN(0, c->seconds + along * c->cosine[i] + aside * c->sine[i]);
    }
    return hidden * length(m);
}

/* The least value at all angles from which a turn leads to this one. */
static void turn(const Chain *c, double rate, const double *before, double *after)
{
    double least = FORBIDDEN;
    if (rate > 0) for (int i = 0; i < c->angles; i++) after[i] = least = MIN(before[i], least);
    else for (int i = c->angles - 1; i >= 0; i--) after[i] = least = MIN(before[i], least);
}

/* The least value where the heading is as wanted, and an angle near it. */
static double at_the_goal(const Chain *c, const double *f, int *angle)
{
    double least = INFINITY;
    Range anywhere = {-c->left * c->step, (c->angles - 1 - c->left) * c->step};
    for (int w = 0; w < (c->wants_heading ? c->wanted_ranges : 1); w++) {
        Range range = c->wants_heading ? c->wanted[w] : anywhere;
        double low = range.low / c->step + c->left, high = range.high / c->step + c->left;
        for (int end = 0; end < 2; end++) {
            double at = end ? high : low;
            int i = (int)at < c->angles - 2 ? (int)at : c->angles - 2;
            double value = f[i] + (at - i) * (f[i + 1] - f[i]);
            if (value < least) { least = value; *angle = (int)lrint(at); }
        }
        for (int i = (int)ceil(low); i <= high && i < c->angles; i++)
            if (f[i] < least) { least = f[i]; *angle = i; }
    }
    return least;
}

/* Where the way ends that is least for m, off the goal: from the last angle back to where its value came from. */
static cplx missed(const Row *row, const Chain *c, cplx m, double f[][ANGLES], int angle)
{
    cplx end = -row->goal;
    for (int j = c->stretches - 1; j >= 0; j--) {
        if (c->rate[j] != 0) {
            int aside = c->rate[j] > 0 ? -1 : 1, best = angle;
            for (int i = angle; i >= 0 && i < c->angles; i += aside) if (f[j][i] < f[j][best]) best = i;
            angle = best;
        }
        cplx factor = c->cosine[angle] + I * c->sine[angle];
        end += factor * c->A[j];
        for (int s = 0; s < c->straights[j]; s++) {
            cplx velocity = factor * c->W[j][s];
            if (1 + dot(m, velocity) < 0) end += velocity * c->seconds;
        }
    }
    return end;
}

/* The bound that m gives, and the way in which it rises with m. */
static double dual_bound(const Row *row, const Chain *c, cplx m, cplx *slope)
{
    double f[MOST + 1][ANGLES], g[ANGLES], hidden = 0, tolerance = reach(row);
    for (int i = 0; i < c->angles; i++) g[i] = FORBIDDEN;
    g[c->left] = 0;
    for (int j = 0; j < c->stretches; j++) {
        memcpy(f[j], g, sizeof(double) * (size_t)c->angles);
        hidden += add_stretch(c, j, m, f[j]);
        if (c->rate[j] != 0) turn(c, c->rate[j], f[j], g);
    }
    int angle = c->left;
    double least = at_the_goal(c, f[c->stretches - 1], &angle), size = length(m);
    double value = row->fixed + least - dot(m, row->goal) - size * tolerance - hidden * c->step * c->step / 8;
    if (value < row->best)
        *slope = missed(row, c, m, f, angle) - (size > 0 ? tolerance * m / size : 0);
    return value;
}

/* Whether no plan with this set of times is faster than the best so far: m climbs until its bound says so. Starts
 * from *m, leaves there the one with the largest bound. */
static int refuted(const Row *row, unsigned mask, int rounds, cplx *m)
{
    Chain c;
    if (!make_chain(&c, row, mask, row->best - row->fixed)) return 0;
    if (c.wants_heading && !c.wanted_ranges) return 1;
    double most = -INFINITY;
    cplx now = *m, slope = 0;
    for (int round = 0; round < rounds && length(now) < TOO_LONG; round++) {
        double value = dual_bound(row, &c, now, &slope);
        if (value > most) { most = value; *m = now; }
        if (value >= row->best) return 1;
        double square = dot(slope, slope);
        if (!(square > 1e-6)) return 0;
        /* As far as a bound with this slope would have to go (Polyak), and a little beyond. */
        now += (1.02 * row->best - value + 0.05) / square * slope;
    }
    return 0;
}
