/* Nearly sharp lower bound of a walk's duration, by weak duality and dynamic programming over headings.
 *
 * For any multiplier m (s/m), no plan that ends within the tolerance of the goal takes less than the least of
 *
 *     seconds + dot(m, end - goal) - |m| tolerance
 *
 * over all coasting times. That is a sum over stretches (coasting.h), with t the most seconds, of
 *
 *     a_j psi_j + dot(m, exp(i psi_j) A_j) + sum over straight coasts of min(0, t (1 + dot(m, exp(i psi_j) W)))
 *
 * with a_j = 1/r_j - 1/r_(j+1). Two neighbouring headings are coupled only by the side to which the turn between them
 * turns, so the least follows by dynamic programming over a grid of headings. Between two points of the grid a
 * function lies below the line through its values by at most its second derivative times the square of the step over
 * 8; running minima, and the lesser of a line and 0, lie above the lines through theirs. So the bound holds between
 * points, too.
 *
 * A turn that turns by less than about one step in the seconds left is a straight coast here, with the tolerances
 * enlarged by the error: as a turn, its long radius would cost more.
 */
#include "coasting.h"

#define GRID 128          /* headings in a full turn, at the finest */
#define COARSEST 4        /* times the finest step is the largest */
#define FEW_ANGLES 40     /* headings: with more the step is doubled */
#define ANGLES 400        /* most headings ... */
#define FINE_ANGLES 154   /* ... and most of the first grid with slow turns or long radii */
#define OTHER_TURNS 8     /* full turns by which wanted headings may differ */
#define FORBIDDEN 1e8     /* times the incumbent: the value of headings that no turn reaches */
#define LONGEST 1e5       /* times the incumbent by the size of the problem: longer multipliers are not improved */
#define TOO_SLOW 2e-3     /* rad in the seconds left: slower turns are straight coasts in any case ... */
#define HARDLY_A_TURN 0.4 /* steps in the seconds left: ... and so are these */
#define FINER 4           /* times more headings in the second grid */
#define SLOW 0.3          /* rad in the seconds left: with a slower turn the first grid may have the most headings */
#define ALLOWANCE 1e-3    /* of the seconds left: allowance for a step that the grid aims at */
#define NO_ASCENT 1e-5    /* of the size: a shorter subgradient is 0 */
#define OVERSHOOT 2.25e-2 /* of the incumbent: by how much an ascent step aims beyond it */

typedef struct { double low, high; } Range;

typedef struct {
    int finer, stretches, straights[MOST + 1];
    cplx A[MOST + 1], W[MOST + 1][MOST];
    double a[MOST + 1], rate[MOST + 1];   /* of the turn after the stretch; 0 after the last */
    double seconds;                       /* s; most of a coast */
    double off, aside;                    /* m, rad; error of all turns taken as straight coasts */
    double sizes;                         /* m; of all A, and of straight coasts of the most seconds */
    double step;                          /* rad; of the grid */
    double allowance;                        /* s; allowance between the points of the grid */
    double forbidden;                     /* s; value of headings that no turn reaches */
    int left, angles;                     /* headings left of 0; all */
    double cosine[ANGLES], sine[ANGLES];
    int wants_heading, wanted_ranges;
    Range wanted[OTHER_TURNS];
} HeadingGrid;

/* Sets the headings that coasts can turn to; returns 0 where they are too many. */
static int set_grid(HeadingGrid *c, double left, double right, double fastest, double slowest)
{
    static const double finest = 2 * PI / GRID;
    double reach = left + right;
    int stride = 1;
    while (stride < COARSEST && reach > finest * stride * FEW_ANGLES) stride *= 2;
    c->step = finest * stride;
    if (!(reach < c->step * (ANGLES - 5))) return 0;
    /* Long radii need small steps, and slow turns most of all. */
    double wanted = sqrt(8 * ALLOWANCE * c->seconds * fastest / c->sizes);
    int most = slowest * c->seconds < SLOW ? FINE_ANGLES : FEW_ANGLES;
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

/* Sets the ranges of wanted headings; returns 0 where they are too many. */
static int set_wanted(HeadingGrid *c, const Problem *p)
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

/* Takes a slow turn as a straight coast, and adds its error: its own displacement, and the rotation of all that
 * follows. */
static void straighten(HeadingGrid *c, const Problem *p, int k, double fastest)
{
    double bent = fabs(p->rate[k]) * c->seconds, after = fastest * c->seconds;
    for (int later = k + 1; later < p->trims; later++) after += p->size_D[later];
    c->off += bent * (0.5 * p->speed[k] * c->seconds + after);
    c->aside += bent;
}

/* Cuts a walk into stretches, turns up to a rate taken as straight coasts, and sets the grid; 0 where that is too
 * large. */
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
    /* No optimal coast exceeds a full turn. */
    return set_grid(c, lesser(left * c->seconds, left_turns), lesser(right * c->seconds, right_turns), fastest, slowest)
        && set_wanted(c, p);
}

/* Sets up the grid of an active set; 0 where it is too large. */
static int make_grid(HeadingGrid *c, const Problem *p, unsigned mask, double seconds, int finer)
{
    double slow = greater(0, TOO_SLOW / seconds), hardly = 0;
    c->seconds = seconds;
    c->finer = finer;
    c->forbidden = FORBIDDEN * p->best;
    if (!cut_at_turns(c, p, mask, slow)) return 0;
    for (int k = 0; k < p->trims; k++) {
        double rate = fabs(p->rate[k]);
        int turns = ((mask >> k) & 1) && rate > slow;
        if (turns && rate <= HARDLY_A_TURN * c->step / seconds) hardly = greater(hardly, rate);
    }
    return hardly == 0 || cut_at_turns(c, p, mask, hardly);
}

/* Adds a stretch's terms at every heading; returns their allowance, in steps squared / 8. */
static double add_stretch(const HeadingGrid *c, int j, cplx m, double *f)
{
    double x = dot(m, c->A[j]), y = dot(m, I * c->A[j]), slope = c->a[j] * c->step, allowance = length(c->A[j]);
    for (int i = 0; i < c->angles; i++)
        f[i] += slope * (i - c->left) + x * c->cosine[i] + y * c->sine[i];
    for (int s = 0; s < c->straights[j]; s++) {
        cplx way = c->seconds * c->W[j][s];
        double along = dot(m, way), aside = dot(m, I * way);
        allowance += length(way);
        for (int i = 0; i < c->angles; i++)
            f[i] += lesser(0, c->seconds + along * c->cosine[i] + aside * c->sine[i]);
    }
    return allowance * length(m);
}

/* Running minimum over the headings from which a turn reaches each heading. */
static void turn(const HeadingGrid *c, double rate, const double *before, double *after)
{
    double least = c->forbidden;
    if (rate > 0) for (int i = 0; i < c->angles; i++) after[i] = least = lesser(before[i], least);
    else for (int i = c->angles - 1; i >= 0; i--) after[i] = least = lesser(before[i], least);
}

/* Least value over the wanted headings, and the heading nearest to it. */
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

/* Miss of the minimiser: backtracks from the last heading. */
static cplx backtrack(const Problem *p, const HeadingGrid *c, cplx m, double f[][ANGLES], int angle)
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

/* The dual bound of m, and its subgradient. */
static double dual_bound(const Problem *p, HeadingGrid *c, cplx m, cplx *slope)
{
    double f[MOST + 1][ANGLES], g[ANGLES], allowance = 0, tolerance = reach(p);
    for (int i = 0; i < c->angles; i++) g[i] = c->forbidden;
    g[c->left] = 0;
    for (int j = 0; j < c->stretches; j++) {
        memcpy(f[j], g, sizeof(double) * (size_t)c->angles);
        allowance += add_stretch(c, j, m, f[j]);
        if (c->rate[j] != 0) turn(c, c->rate[j], f[j], g);
    }
    int angle = c->left;
    double least = at_the_goal(c, f[c->stretches - 1], &angle), size = length(m);
    c->allowance = allowance * c->step * c->step / 8;
    double value = p->fixed + least - dot(m, p->goal) - size * (tolerance + c->off) - c->allowance;
    if (value < p->best)
        *slope = backtrack(p, c, m, f, angle) - (size > 0 ? (tolerance + c->off) * m / size : 0);
    return value;
}

/* Ascent of m (Polyak's rule) until the bound reaches the incumbent; *m becomes the best multiplier, *shortfall the
 * seconds by which even the finest grid falls short there. Returns whether the incumbent was reached. */
static int ascend(const Problem *p, HeadingGrid *c, int rounds, double size, cplx *m, double *shortfall)
{
    double most = -INFINITY;
    cplx now = *m, slope = 0;
    for (int round = 0; round < rounds && length(now) * size < LONGEST * p->best; round++) {
        double value = dual_bound(p, c, now, &slope);
        if (value > most) {
            most = value;
            *m = now;
            *shortfall = p->best - value - c->allowance;
        }
        if (value >= p->best) return 1;
        double square = dot(slope, slope);
        if (!(square > NO_ASCENT * NO_ASCENT * size * size)) return 0;
        /* Polyak's step to the incumbent, and a little beyond. */
        now += ((1 + OVERSHOOT) * p->best - value) / square * slope;
    }
    return 0;
}

/* Whether an active set is dominated by the incumbent; starts from *m, which becomes the best multiplier. */
int refuted(const Problem *p, unsigned mask, int rounds, cplx *m)
{
    HeadingGrid c;
    double size = length(p->goal);
    for (int k = 0; k < p->trims; k++) size += p->size_D[k];
    for (int finer = 1; finer <= FINER; finer *= FINER) {
        double shortfall = INFINITY;
        if (!make_grid(&c, p, mask, p->best - p->fixed, finer)) return 0;
        if (c.wants_heading && !c.wanted_ranges) return 1;
        if (ascend(p, &c, rounds, size, m, &shortfall)) return 1;
        if (shortfall > 0) return 0;
    }
    return 0;
}
