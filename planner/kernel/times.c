/* Every coasting time that can be best, for one walk at one uncertainty level.
 *
 * Positions are complex (north + i east), seen from the start with heading 0. With a heading psi that only
 * coasting changes (what the maneuvers turn is folded into W, C and D), the end of the walk is
 *
 *     sum over stretches j of exp(i psi_j) (A_j + the straight coasts of the stretch),
 *
 * where each coast in a turn begins a new stretch. At a best point there is a multiplier m = exp(i alpha) / u
 * with Re(conj(m) v) = -1 for the end velocity v of every time that is not 0, and the end stands off the goal
 * by the tolerance in the direction of m. Seen from alpha, chi_j = psi_j - alpha:
 *
 *     Im(exp(i chi_j) A_j) = u a_j   with a_j = 1/r_j - 1/r_(j+1)   for a stretch without a straight coast,
 *     Re(exp(i chi_j) w) = -u        with w its velocity            for a stretch with one,
 *
 * so that every heading follows from the single number u (up to a sign each). The goal is one stretch more, which
 * closes the way: across alpha the stretches then add up to 0 of themselves, along alpha there is one equation,
 *
 *     sum over j of +-sqrt(|A_j|^2 - a_j^2 u^2) = tolerance,
 *
 * (a stretch with a straight coast adds another simple term). Its roots, over all sets of times that are not 0
 * and all signs, are all candidates.
 * As many times as equations need no u: they are intersections of lines and circles.
 */
#include <complex.h>
#include <math.h>
#include <string.h>

#define MOST 12           /* trims in a walk */
#define ALL_BUT_STRAIGHT 1e-8 /* rad in all; turns that turn less are found as straight lines and corrected ... */
#define HARDLY_BENT 1e-5  /* rad in all; ... and those that turn less than this in both ways */
#define LONG 1e4          /* s; as long as no plan is known that says how long a coast can be */
#define INTERVALS 16      /* samples along a curve of candidates */
#define SMALL 1e-9        /* s; shorter times are 0 */
#define ROUNDING 1e-15    /* of the largest term of a sum */
#define SAME_RATE 1e-12   /* of a yaw rate */
#define EXACT 1e-12       /* rad; rounding of a heading ... */
#define BLUR 3e-8         /* rad; ... and near the end of its curve */
#define MOST_HALVED 60    /* times that a piece of a curve is halved */
#define TOLD_APART 0.1    /* of the slack; pieces that vary by less are no further halved */

typedef double complex cplx;

/* In line; of a number and a not-a-number they return the latter. */
#define MIN(a, b) ({ double a_ = (a), b_ = (b); a_ < b_ ? a_ : b_; })
#define MAX(a, b) ({ double a_ = (a), b_ = (b); a_ > b_ ? a_ : b_; })

typedef struct {
    int trims;
    const double *rate;          /* rad/s */
    const cplx *W, *C, *D;       /* velocity, centre of the turn, displacement of the maneuver before */
    double fixed;                /* s in maneuvers */
    cplx goal;
    double tolerance;            /* m; candidates use all of it ... */
    double slack;                /* m; ... and may be off by that much more through rounding */
    int wants_heading;
    double heading;              /* what coasting has to turn, rad, modulo full turns */
    double heading_tolerance, heading_slack;
    const double *bearing_D, *bearing_W, *size_D, *speed;  /* D and W, polar */
    double best;                 /* s; only faster ones are kept */
    cplx worth;                  /* s/m; near the multiplier of the best times */
    double straight, hardly_bent; /* rad/s; slower turns are taken as straight lines, or in both ways */
    double times[MOST];
} Row;

typedef struct {                 /* times that are taken to be not 0 */
    int count, place[MOST];
    int turns;                   /* turning ones among them */
    int bound_heading;           /* whether the heading at the end is at a limit */
    double target;               /* that limit */
    int shared;                  /* whether turns at one rate share a bound heading */
    double slowest;              /* rad/s; of those that turn at all */
    int slow;                    /* whether straight lines stand for slow turns */
    int blurred;                 /* whether turns are so slow that rounding of a heading is much of their time */
} Active;

typedef struct {                 /* a stretch whose heading is free */
    cplx A, w;
    double a, size, speed, limit;
    double above, K, aside;      /* stretches.c */
    double rate;                 /* of the turn that it begins with */
    int straight;                /* place in the walk of its straight coast; -1 without */
    int other;                   /* a second one; -1 without */
    cplx w_other;
} Stretch;

/* m from the goal that count as reached. */
static double reach(const Row *row) { return row->tolerance + row->slack; }

static double cross(cplx one, cplx two) { return creal(one) * cimag(two) - cimag(one) * creal(two); }
static double dot(cplx one, cplx two) { return creal(one) * creal(two) + cimag(one) * cimag(two); }
static cplx turned(double angle) { return cos(angle) + I * sin(angle); }

/* Where the walk ends, how the end moves with each time, and what coasting has turned. */
static cplx motion(const Row *row, const double *times, cplx *velocity, double *turn)
{
    cplx position = 0, after[MOST], own[MOST], factor = 1;
    double psi = 0;
    for (int k = 0; k < row->trims; k++) {
        position += factor * row->D[k];
        if (times[k] != 0) {
            double half = 0.5 * row->rate[k] * times[k];
            cplx bent = turned(half);
            double shrunk = half != 0 ? sin(half) / half : 1.0;
            position += factor * row->W[k] * times[k] * shrunk * bent;
            factor *= bent * bent;
            psi += 2 * half;
        }
        own[k] = factor * row->W[k];
        after[k] = position;
    }
    for (int k = 0; velocity && k < row->trims; k++)
        velocity[k] = own[k] + I * row->rate[k] * (position - after[k]);
    if (turn) *turn = psi;
    return position;
}

static int eliminate(double *M, double *b, int n)
{
    for (int c = 0; c < n; c++) {
        int pivot = c;
        for (int r = c + 1; r < n; r++)
            if (fabs(M[r * n + c]) > fabs(M[pivot * n + c])) pivot = r;
        if (!(fabs(M[pivot * n + c]) > 1e-14)) return 0;
        if (pivot != c) {
            for (int k = c; k < n; k++) {
                double s = M[c * n + k]; M[c * n + k] = M[pivot * n + k]; M[pivot * n + k] = s;
            }
            double s = b[c]; b[c] = b[pivot]; b[pivot] = s;
        }
        for (int r = c + 1; r < n; r++) {
            double f = M[r * n + c] / M[c * n + c];
            if (f == 0) continue;
            for (int k = c; k < n; k++) M[r * n + k] -= f * M[c * n + k];
            b[r] -= f * b[c];
        }
    }
    for (int r = n - 1; r >= 0; r--) {
        for (int k = r + 1; k < n; k++) b[r] -= M[r * n + k] * b[k];
        b[r] /= M[r * n + r];
    }
    return 1;
}

/* To the nearest whole number, for numbers below 2^51. */
static double whole(double value) { return (value + 0x1.8p52) - 0x1.8p52; }
static double off_turns(double angle) { return angle - 2 * M_PI * whole(angle / (2 * M_PI)); }

/* Newton on what holds at a best point: for as many times as equations the equations alone (m = 0). */
static int newton(const Row *row, const Active *on, double *times, cplx m)
{
    int n = on->count, determined = m == 0;
    double lambda = 0;
    for (int round = 0; round < 20; round++) {
        cplx velocity[MOST];
        double turn, M[(MOST + 3) * (MOST + 3)], b[MOST + 3];
        cplx miss = motion(row, times, velocity, &turn) - row->goal;
        int ends = determined && row->tolerance > 0 ? 1 : 2;
        int size = (determined ? 0 : n + 2 + on->bound_heading);
        int rows = determined ? ends + on->bound_heading : size;
        if (determined) { if (rows != n) return 0; size = n; }
        memset(M, 0, sizeof(double) * size * size);
        int first = determined ? 0 : n;
        if (!determined && on->bound_heading && round == 0) {
            double fastest = 0;
            for (int j = 0; j < n; j++) {
                double rate = row->rate[on->place[j]];
                if (!(fabs(rate) > fastest)) continue;
                fastest = fabs(rate);
                lambda = -(1 + dot(m, velocity[on->place[j]])) / rate;
            }
        }
        for (int j = 0; !determined && j < n; j++) {
            int pj = on->place[j];
            b[j] = -(1 + dot(m, velocity[pj]) + lambda * row->rate[pj]);
            for (int i = 0; i < n; i++) {
                int low = i < j ? i : j, high = i < j ? j : i;
                M[j * size + i] = dot(m, I * row->rate[on->place[low]] * velocity[on->place[high]]);
            }
            M[j * size + n] = creal(velocity[pj]);
            M[j * size + n + 1] = cimag(velocity[pj]);
            if (on->bound_heading) M[j * size + n + 2] = row->rate[pj];
        }
        if (ends == 1) {
            b[first] = -0.5 * (creal(miss * conj(miss)) - row->tolerance * row->tolerance);
            for (int i = 0; i < n; i++) M[first * size + i] = dot(miss, velocity[on->place[i]]);
        } else {
            cplx wanted = 0;
            if (row->tolerance > 0) {
                double length = cabs(m), share = row->tolerance / length;
                cplx normal = m / length;
                wanted = row->tolerance * normal;
                double x = creal(normal), y = cimag(normal);
                M[first * size + n] = -share * (1 - x * x);
                M[first * size + n + 1] = M[(first + 1) * size + n] = share * x * y;
                M[(first + 1) * size + n + 1] = -share * (1 - y * y);
            }
            b[first] = -creal(miss - wanted);
            b[first + 1] = -cimag(miss - wanted);
            for (int i = 0; i < n; i++) {
                M[first * size + i] = creal(velocity[on->place[i]]);
                M[(first + 1) * size + i] = cimag(velocity[on->place[i]]);
            }
        }
        if (on->bound_heading) {
            int last = first + ends;
            b[last] = -off_turns(turn - on->target);
            for (int i = 0; i < n; i++) M[last * size + i] = row->rate[on->place[i]];
        }
        double error = 0;
        for (int i = first; i < size; i++) error = MAX(error, fabs(b[i]));
        if (!eliminate(M, b, size)) return error < 1e-10;
        double step = 0;
        for (int i = 0; i < n; i++) {
            step = MAX(step, fabs(b[i]));
            times[on->place[i]] += b[i];
        }
        if (!(step < 1e4)) return 0;
        if (!determined) {
            m += b[n] + I * b[n + 1];
            if (on->bound_heading) lambda += b[n + 2];
        }
        if (step < 1e-12) return 1;
    }
    return 1;
}

/* Keeps times that reach the goal faster than the best so far; returns whether they reach it. */
static int keep(Row *row, double *times)
{
    double cost = row->fixed, turn;
    for (int k = 0; k < row->trims; k++) {
        if (!(times[k] >= -SMALL)) return 0;
        if (times[k] < 0) times[k] = 0;
        cost += times[k];
    }
    cplx end = motion(row, times, 0, &turn);
    if (!(cabs(end - row->goal) <= reach(row))) return 0;
    if (row->wants_heading
        && !(fabs(off_turns(turn - row->heading)) <= row->heading_tolerance + row->heading_slack))
        return 0;
    if (!(cost < row->best)) return 1;
    row->best = cost;
    memcpy(row->times, times, sizeof(double) * row->trims);
    return 1;
}

static void propose(Row *row, const Active *on, const double *of_active, cplx m)
{
    double times[MOST] = {0}, cost = row->fixed, slack = MAX(1e-6, EXACT / on->slowest);
    if (on->slow || on->blurred) slack = 1;
    for (int i = 0; i < on->count; i++) {
        if (!(of_active[i] >= -slack)) return;
        times[on->place[i]] = of_active[i];
        cost += of_active[i];
    }
    if (!(cost < row->best + (on->slow || on->blurred ? 0.05 * cost : 10 * slack))) return;
    double guess[MOST];
    memcpy(guess, times, sizeof(guess));
    int solved = newton(row, on, times, m);
    double way = 0, tolerance = row->tolerance;
    for (int i = 0; i < on->count; i++) way += row->speed[on->place[i]] * times[on->place[i]];
    if (solved && EXACT / 100 * way > row->slack && tolerance > 0) {
        /* The end is rounded in proportion to the way: so much further inside. */
        row->tolerance = MAX(0.5 * tolerance, tolerance - EXACT / 100 * way);
        newton(row, on, times, m);
        row->tolerance = tolerance;
    }
    /* Where two times move the end alike, or at the edge of reach, the equations are singular; the guess may do. */
    if (!solved || !keep(row, times)) keep(row, guess);
}

/* Times of the active turns from the headings after them; straight times are given. */
static void times_of(const Row *row, const Active *on, const cplx *heading, const double *straight, double *times)
{
    cplx before = 1;
    for (int i = 0, j = 0; i < on->count; i++) {
        double rate = row->rate[on->place[i]];
        if (fabs(rate) <= row->straight) { times[i] = straight[on->place[i]]; continue; }
        cplx after = heading[++j];
        double angle = carg(after * conj(before)), time = angle / rate;
        if (time < 0 && fabs(angle) > (on->blurred ? BLUR : EXACT)) time += 2 * M_PI / fabs(rate);
        times[i] = time;
        before = after;
    }
}

static void from_headings(Row *row, const Active *on, const cplx *heading, const double *straight, cplx m)
{
    double times[MOST];
    times_of(row, on, heading, straight, times);
    propose(row, on, times, m);
}
