/* A bound of a walk's seconds that is nearly sharp: weak duality, the headings chosen by dynamic programming.
 *
 * For any vector m (s/m), no plan that ends within the tolerance of the goal takes less than the least of
 *
 *     seconds + dot(m, end - goal) - |m| tolerance
 *
 * over all coasting times. That is a sum over stretches (coasting.h) of
 *
 *     a_j psi_j + dot(m, exp(i psi_j) A_j) + straight coasts' min(0, t (1 + dot(m, exp(i psi_j) W))), t the most seconds,
 *
 * with a_j = 1/r_j - 1/r_(j+1), in which two neighbours are bound by nothing but the side that the turn between
 * them turns to. So the least is found from stretch to stretch, as a function of the heading on a grid. Between
 * two angles of it a function lies below the line through its values by no more than its second derivative
 * times the square of the step over 8, and the least value so far, and the lesser of such a line and 0, lie above
 * the lines through theirs: the bound holds between the angles, too.
 *
 * A turn that bends by less than about the step in the seconds that are left is taken as a straight coast: its radius
 * would hide more than what it bends. By how much way and heading may then be off is allowed for.
 */
#include "coasting.h"

#define GRID 128          /* angles in a turn, at the finest */
#define COARSEST 4        /* of them make the largest step */
#define ENOUGH 40         /* angles: with more the step is doubled */
#define ANGLES 400        /* most of them ... */
#define FINE 154          /* ... and most where a step is made small */
#define OTHER_TURNS 8     /* full turns by which wanted headings may differ */
#define FORBIDDEN 1e8     /* times the best seconds: no heading of the way */
#define TOO_LONG 1e5      /* times the best seconds a size: multipliers so long climb no more */
#define TOO_SLOW 2e-3     /* rad in the seconds that are left: slower turns are straight coasts in any case ... */
#define HARDLY_A_TURN 0.4 /* steps in the seconds that are left: ... and so are these */
#define FINER 4           /* times more angles where they may do what these do not */
#define SLOW 0.3          /* rad in the seconds that are left: a set with a slower turn may have all angles */
#define HIDDEN 1e-3       /* of the seconds that are left: what a step should hide, if there are angles enough for it */
#define ARRIVED 1e-5      /* of the size: what misses by less is no way to climb */
#define FURTHER 2.25e-2   /* of the best seconds: what a climb aims beyond */

typedef struct { double low, high; } Range;

typedef struct {
    int finer, stretches, straights[MOST + 1];
    cplx A[MOST + 1], W[MOST + 1][MOST];
    double a[MOST + 1], rate[MOST + 1];   /* of the turn after the stretch; 0 after the last */
    double seconds;                       /* that coasts may take */
    double off, aside;                    /* m, rad; by which turns taken as straight coasts are off in all */
    double sizes;                         /* m; of all A, and of the ways that straight coasts may make */
    double step;                          /* rad between angles */
    double hidden;                        /* s; what lines between angles may hide */
    double forbidden;                     /* s; the value of headings that are not on the way */
    int left, angles;                     /* those to the left of heading 0; all */
    double cosine[ANGLES], sine[ANGLES];
    int wants_heading, wanted_ranges;
    Range wanted[OTHER_TURNS];
} HeadingGrid;

/* The angles that coasts can turn to in the seconds; 0 if they are too many. */
static int lay_grid(HeadingGrid *c, double left, double right, double fastest, double slowest)
{
    static const double finest = 2 * PI / GRID;
    double reach = left + right;
    int stride = 1;
    while (stride < COARSEST && reach > finest * stride * ENOUGH) stride *= 2;
    c->step = finest * stride;
    if (!(reach < c->step * (ANGLES - 5))) return 0;
    /* Long radii want small steps, more of them where a turn is slow. */
    double wanted = sqrt(8 * HIDDEN * c->seconds * fastest / c->sizes);
    int most = slowest * c->seconds < SLOW ? FINE : ENOUGH;
    if (wanted > 0 && wanted < c->step) c->step = greater(wanted, reach / most);
    c->step = greater(c->step / c->finer, reach / (ANGLES - 6));
    c->left = (int)(left / c->step) + 1;
    c->angles = c->left + (int)(right / c->step) + 2;
    cplx factor = unit_complex(-c->left * c->step), onward = unit_complex(c->step);
    for (int i = 0; i < c->angles; i++, factor *= onward) {
        c->cosine[i] = creal(factor);
        c->sine[i] = cimag(factor);
    }
    return 1;
}

/* The parts of the grid where the heading at the end is as wanted; 0 if they are too many. */
static int find_wanted(HeadingGrid *c, const Problem *p)
{
    double slack = p->heading_tolerance + p->heading_slack + c->aside;
    c->wants_heading = p->wants_heading && slack < PI;
    c->wanted_ranges = 0;
    if (!c->wants_heading) return 1;
    double least = -c->left * c->step, most = (c->angles - 1 - c->left) * c->step;
    double first = ceil((least - slack - p->heading) / (2 * PI));
    double last = floor((most + slack - p->heading) / (2 * PI));
    for (double turns = first; turns <= last; turns++) {
        if (c->wanted_ranges == OTHER_TURNS) return 0;
        double middle = p->heading + 2 * PI * turns;
        c->wanted[c->wanted_ranges++] = (Range){greater(least, middle - slack), lesser(most, middle + slack)};
    }
    return 1;
}

/* Takes a slow turn as a straight coast: what it bends moves its own way and turns all that comes after. */
static void straighten(HeadingGrid *c, const Problem *p, int k, double fastest)
{
    double bent = fabs(p->rate[k]) * c->seconds, after = fastest * c->seconds;
    for (int later = k + 1; later < p->trims; later++) after += p->size_D[later];
    c->off += bent * (0.5 * p->speed[k] * c->seconds + after);
    c->aside += bent;
}

/* The stretches that a set of times makes, turns up to a rate taken as straight coasts, and the angles; 0 where these
 * are too many. */
static int cut_at_turns(HeadingGrid *c, const Problem *p, unsigned mask, double slow)
{
    int j = 0;
    double right = 0, left = 0, right_turns = 0, left_turns = 0, before = 0, fastest = 0, slowest = INFINITY;
    c->off = c->aside = c->sizes = 0;
    c->A[0] = 0;
    c->straights[0] = 0;
    for (int k = 0; k < p->trims; k++) if ((mask >> k) & 1) fastest = greater(fastest, p->speed[k]);
    for (int k = 0; k < p->trims; k++) {
        double rate = p->rate[k];
        c->A[j] += p->D[k];
        if (!((mask >> k) & 1)) continue;
        if (fabs(rate) <= slow) {
            c->W[j][c->straights[j]++] = p->W[k];
            c->sizes += p->speed[k] * c->seconds;
            if (rate != 0) straighten(c, p, k, fastest);
            continue;
        }
        c->A[j] -= p->C[k];
        c->a[j] = before - 1 / rate;
        c->rate[j] = rate;
        c->sizes += length(c->A[j]);
        before = 1 / rate;
        right = greater(right, rate);
        left = greater(left, -rate);
        *(rate > 0 ? &right_turns : &left_turns) += 2 * PI;
        slowest = lesser(slowest, fabs(rate));
        c->A[++j] = p->C[k];
        c->straights[j] = 0;
    }
    c->a[j] = before;
    c->rate[j] = 0;
    c->sizes += length(c->A[j]);
    c->stretches = j + 1;
    /* No best time is longer than a full turn. */
    return lay_grid(c, lesser(left * c->seconds, left_turns), lesser(right * c->seconds, right_turns), fastest, slowest)
        && find_wanted(c, p);
}

/* The grid for a set of times; 0 where turns or headings are too many for it. */
static int make_grid(HeadingGrid *c, const Problem *p, unsigned mask, double seconds, int finer)
{
    double slow = greater(0, TOO_SLOW / seconds), hardly = 0;
    c->seconds = seconds;
    c->finer = finer;
    c->forbidden = FORBIDDEN * p->best;
    if (!cut_at_turns(c, p, mask, slow)) return 0;
    for (int k = 0; k < p->trims; k++) {
        double rate = fabs(p->rate[k]);
        if (((mask >> k) & 1) && rate > slow && rate <= HARDLY_A_TURN * c->step / seconds) hardly = greater(hardly, rate);
    }
    return hardly == 0 || cut_at_turns(c, p, mask, hardly);
}

/* Adds what a stretch costs at every angle; returns what a line between two angles may hide, in steps squared / 8. */
static double add_stretch(const HeadingGrid *c, int j, cplx m, double *f)
{
    double x = dot(m, c->A[j]), y = dot(m, I * c->A[j]), slope = c->a[j] * c->step, hidden = length(c->A[j]);
    for (int i = 0; i < c->angles; i++)
        f[i] += slope * (i - c->left) + x * c->cosine[i] + y * c->sine[i];
    for (int s = 0; s < c->straights[j]; s++) {
        cplx way = c->seconds * c->W[j][s];
        double along = dot(m, way), aside = dot(m, I * way);
        hidden += length(way);
        for (int i = 0; i < c->angles; i++)
            f[i] += lesser(0, c->seconds + along * c->cosine[i] + aside * c->sine[i]);
    }
    return hidden * length(m);
}

/* The least value at all angles from which a turn leads to this one. */
static void turn(const HeadingGrid *c, double rate, const double *before, double *after)
{
    double least = c->forbidden;
    if (rate > 0) for (int i = 0; i < c->angles; i++) after[i] = least = lesser(before[i], least);
    else for (int i = c->angles - 1; i >= 0; i--) after[i] = least = lesser(before[i], least);
}

/* The least value where the heading is as wanted, and an angle near it. */
static double at_the_goal(const HeadingGrid *c, const double *f, int *angle)
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
static cplx missed(const Problem *p, const HeadingGrid *c, cplx m, double f[][ANGLES], int angle)
{
    cplx end = -p->goal;
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
static double dual_bound(const Problem *p, HeadingGrid *c, cplx m, cplx *slope)
{
    double f[MOST + 1][ANGLES], g[ANGLES], hidden = 0, tolerance = reach(p);
    for (int i = 0; i < c->angles; i++) g[i] = c->forbidden;
    g[c->left] = 0;
    for (int j = 0; j < c->stretches; j++) {
        memcpy(f[j], g, sizeof(double) * (size_t)c->angles);
        hidden += add_stretch(c, j, m, f[j]);
        if (c->rate[j] != 0) turn(c, c->rate[j], f[j], g);
    }
    int angle = c->left;
    double least = at_the_goal(c, f[c->stretches - 1], &angle), size = length(m);
    c->hidden = hidden * c->step * c->step / 8;
    double value = p->fixed + least - dot(m, p->goal) - size * (tolerance + c->off) - c->hidden;
    if (value < p->best)
        *slope = missed(p, c, m, f, angle) - (size > 0 ? (tolerance + c->off) * m / size : 0);
    return value;
}

/* Whether m climbs to a bound that excludes plans faster than the best so far; leaves in *m the one with the largest
 * bound, and in *lacking the seconds by which even the finest grid would fall short there. */
static int climbs(const Problem *p, HeadingGrid *c, int rounds, double size, cplx *m, double *lacking)
{
    double most = -INFINITY;
    cplx now = *m, slope = 0;
    for (int round = 0; round < rounds && length(now) * size < TOO_LONG * p->best; round++) {
        double value = dual_bound(p, c, now, &slope);
        if (value > most) {
            most = value;
            *m = now;
            *lacking = p->best - value - c->hidden;
        }
        if (value >= p->best) return 1;
        double square = dot(slope, slope);
        if (!(square > ARRIVED * ARRIVED * size * size)) return 0;
        /* As far as a bound with this slope would have to go (Polyak), and a little beyond. */
        now += ((1 + FURTHER) * p->best - value) / square * slope;
    }
    return 0;
}

/* Whether no plan with this set of times is faster than the best so far, by multipliers from *m on; leaves there the
 * one with the largest bound. */
int refuted(const Problem *p, unsigned mask, int rounds, cplx *m)
{
    HeadingGrid c;
    double size = length(p->goal);
    for (int k = 0; k < p->trims; k++) size += p->size_D[k];
    for (int finer = 1; finer <= FINER; finer *= FINER) {
        double lacking = INFINITY;
        if (!make_grid(&c, p, mask, p->best - p->fixed, finer)) return 0;
        if (c.wants_heading && !c.wanted_ranges) return 1;
        if (climbs(p, &c, rounds, size, m, &lacking)) return 1;
        if (lacking > 0) return 0;
    }
    return 0;
}
