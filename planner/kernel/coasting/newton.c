/* Newton's method on the true motion: for feasible and for stationary coasting times. */
#include "coasting.h"

#define SINGULAR 1e-14    /* of the largest entry of a row: smaller pivots are rounding */
#define ROUNDS 20
#define STILL 1e-13       /* of the longest time: smaller steps are rounding */
#define AWAY 1e3          /* of the longest time: larger steps diverge */
#define NEGATIVE 1e-7     /* units; a candidate's negative time that may be 0 */
#define HEADING_ROUNDING 1e-12 /* rad, of a candidate ... */
#define BLUR 3e-8         /* rad; ... and near the end of its curve */
#define WAY_ROUNDING 1e-14 /* of the path length: rounding of its end */
#define FAR 1e-3          /* of the longest time: Newton's method found another solution than the candidate */
#define BENT 0.05         /* of a cost: error of a slow turn taken as a straight line */

/* Gaussian elimination with pivots, rows scaled; returns 0 for singular equations. */
int solve_linear(double *M, double *b, int n)
{
    for (int r = 0; r < n; r++) {
        double largest = 0;
        for (int k = 0; k < n; k++) largest = greater(largest, fabs(M[r * n + k]));
        if (!(largest > 0)) return 0;
        for (int k = 0; k < n; k++) M[r * n + k] /= largest;
        b[r] /= largest;
    }
    for (int c = 0; c < n; c++) {
        int pivot = c;
        for (int r = c + 1; r < n; r++)
            if (fabs(M[r * n + c]) > fabs(M[pivot * n + c])) pivot = r;
        if (!(fabs(M[pivot * n + c]) > SINGULAR)) return 0;
        for (int k = c; k < n; k++) {
            double s = M[c * n + k];
            M[c * n + k] = M[pivot * n + k];
            M[pivot * n + k] = s;
        }
        double s = b[c];
        b[c] = b[pivot];
        b[pivot] = s;
        for (int r = c + 1; r < n; r++) {
            double f = M[r * n + c] / M[c * n + c];
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

/* Equations of the goal and their Jacobian: distance or both parts of the miss, and the heading where it is bound.
 * Returns the number of equations. */
static int goal_equations(const Problem *p, const ActiveSet *on, const double *times, double *J, double *e)
{
    cplx velocity[MOST];
    double turned;
    int n = on->count, rows = p->tolerance > 0 ? 1 : 2;
    cplx miss = motion(p, times, velocity, &turned) - p->goal;
    e[0] = p->tolerance > 0 ? cabs(miss) - p->tolerance : creal(miss);
    e[1] = cimag(miss);
    for (int i = 0; i < n; i++) {
        cplx v = velocity[on->place[i]];
        J[i] = p->tolerance > 0 ? dot(miss, v) / cabs(miss) : creal(v);
        J[n + i] = cimag(v);
    }
    if (!on->bound_heading) return rows;
    e[rows] = off_turns(turned - on->target);
    for (int i = 0; i < n; i++) J[rows * n + i] = p->rate[on->place[i]];
    return rows + 1;
}

/* Least-norm step with fewer equations than times, least-squares step with more. */
static int least_step(double *J, double *e, int rows, int n, double *step)
{
    double M[3 * MOST], b[MOST];
    int size = rows < n ? rows : n, inner = rows < n ? n : rows;
    for (int i = 0; i < rows; i++) e[i] = -e[i];
    if (rows == n) {
        memcpy(step, e, sizeof(double) * (size_t)n);
        return solve_linear(J, step, n);
    }
    int down = rows < n ? n : 1, over = rows < n ? 1 : n;
    for (int i = 0; i < size; i++) {
        b[i] = rows < n ? e[i] : 0;
        for (int k = 0; k < inner && rows > n; k++) b[i] += J[k * n + i] * e[k];
        for (int j = 0; j < size; j++) {
            M[i * size + j] = 0;
            for (int k = 0; k < inner; k++) M[i * size + j] += J[i * down + k * over] * J[j * down + k * over];
        }
    }
    if (!solve_linear(M, b, size)) return 0;
    for (int j = 0; j < n; j++) {
        step[j] = rows < n ? 0 : b[j];
        for (int i = 0; i < rows && rows < n; i++) step[j] += J[i * n + j] * b[i];
    }
    return 1;
}

/* Adds a step; returns 1 where it was rounding, -1 where it diverges. */
static int take_step(const ActiveSet *on, double *times, const double *step)
{
    double largest = 0, longest = 1;
    for (int i = 0; i < on->count; i++) {
        largest = greater(largest, fabs(step[i]));
        longest = greater(longest, fabs(times[on->place[i]]));
        times[on->place[i]] += step[i];
    }
    if (!(largest < AWAY * longest)) return -1;
    return largest <= STILL * longest;
}

/* Newton's method for feasible times; returns whether it converged. */
static int meet_goal(const Problem *p, const ActiveSet *on, double *times)
{
    for (int round = 0; round < ROUNDS; round++) {
        double J[3 * MOST], e[3], step[MOST];
        int rows = goal_equations(p, on, times, J, e);
        if (!least_step(J, e, rows, on->count, step)) return 0;
        int done = take_step(on, times, step);
        if (done) return done > 0;
    }
    return 1;
}

/* A starting value of the heading's multiplier: the fastest turn is stationary. */
static double first_lambda(const Problem *p, const ActiveSet *on, const cplx *velocity, cplx m)
{
    double fastest = 0, lambda = 0;
    for (int i = 0; i < on->count; i++) {
        double rate = p->rate[on->place[i]];
        if (!(fabs(rate) > fastest)) continue;
        fastest = fabs(rate);
        lambda = -(1 + dot(m, velocity[on->place[i]])) / rate;
    }
    return lambda;
}

/* Newton's method for stationary times: the goal is met, and with the multipliers m and, for a bound heading, lambda
 * every time is stationary. Returns whether it converged. */
static int make_stationary(const Problem *p, const ActiveSet *on, double *times, cplx m)
{
    int n = on->count, size = n + 2 + on->bound_heading;
    double lambda = 0;
    for (int round = 0; round < ROUNDS; round++) {
        cplx velocity[MOST];
        double turned, M[(MOST + 3) * (MOST + 3)] = {0}, b[MOST + 3];
        cplx miss = motion(p, times, velocity, &turned) - p->goal;
        if (on->bound_heading && !round) lambda = first_lambda(p, on, velocity, m);
        double size_m = length(m), share = p->tolerance / size_m;
        cplx normal = m / size_m;
        for (int j = 0; j < n; j++) {
            cplx v = velocity[on->place[j]];
            double rate = p->rate[on->place[j]];
            b[j] = -(1 + dot(m, v) + lambda * rate);
            for (int i = 0; i < n; i++) {
                int first = on->place[i < j ? i : j], last = on->place[i < j ? j : i];
                M[j * size + i] = dot(m, I * p->rate[first] * velocity[last]);
            }
            M[j * size + n] = M[n * size + j] = creal(v);
            M[j * size + n + 1] = M[(n + 1) * size + j] = cimag(v);
            if (on->bound_heading) M[j * size + n + 2] = M[(n + 2) * size + j] = rate;
        }
        double x = creal(normal), y = cimag(normal);
        M[n * size + n] = -share * (1 - x * x);
        M[n * size + n + 1] = M[(n + 1) * size + n] = share * x * y;
        M[(n + 1) * size + n + 1] = -share * (1 - y * y);
        cplx off = miss - p->tolerance * normal;
        b[n] = -creal(off);
        b[n + 1] = -cimag(off);
        if (on->bound_heading) b[n + 2] = -off_turns(turned - on->target);
        if (!solve_linear(M, b, size)) return 0;
        int done = take_step(on, times, b);
        if (done) return done > 0;
        m += b[n] + I * b[n + 1];
        if (on->bound_heading) lambda += b[n + 2];
    }
    return 1;
}

/* Whether corrected times are another solution than their guess. */
static int is_far(const ActiveSet *on, const double *times, const double *guess)
{
    double largest = 0, longest = 1;
    for (int i = 0; i < on->count; i++) {
        largest = greater(largest, fabs(times[on->place[i]] - guess[on->place[i]]));
        longest = greater(longest, fabs(guess[on->place[i]]));
    }
    return largest > FAR * longest;
}

/* Corrects a candidate and submits it as the incumbent; m is its multiplier, 0 without one. */
static void propose(Problem *p, const ActiveSet *on, const double *of_active, cplx m)
{
    double times[MOST] = {0}, guess[MOST], cost = p->fixed, way = 0, tolerance = p->tolerance;
    for (int i = 0; i < on->count; i++) cost += of_active[i];
    int rough = on->slow || on->blurred;
    double off = rough ? BENT * (1 + fabs(cost)) : greater(NEGATIVE, HEADING_ROUNDING / on->slowest);
    for (int i = 0; i < on->count; i++) {
        if (!(of_active[i] >= -off)) return;
        times[on->place[i]] = of_active[i];
        way += p->speed[on->place[i]] * of_active[i];
    }
    if (!(cost < p->best + 10 * off)) return;
    memcpy(guess, times, sizeof(guess));
    int solved = m == 0 ? meet_goal(p, on, times) : make_stationary(p, on, times, m);
    if (solved && WAY_ROUNDING * way > p->slack && tolerance > 0) {
        /* The end is rounded in proportion to the path: aim so much further inside. */
        p->tolerance = greater(0.5 * tolerance, tolerance - WAY_ROUNDING * way);
        solved = m == 0 ? meet_goal(p, on, times) : make_stationary(p, on, times, m);
        p->tolerance = tolerance;
    }
    /* Singular equations (two times with one effect, the edge of reach): the guess may be exact enough, and where a
     * path touches the tolerance Newton's method may end in another solution. */
    if (!solved || !update_best(p, times) || is_far(on, times, guess)) update_best(p, guess);
}

/* Times of the active turns from the headings after them; times of straight coasts are given. A negative turn is
 * completed to a full one; one of 0 within rounding may be either, and their number is returned. */
static int times_of(const Problem *p, const ActiveSet *on, const cplx *heading, const double *straight, int full,
                    double *times)
{
    int unclear = 0;
    cplx before = 1;
    for (int i = 0, j = 0; i < on->count; i++) {
        double rate = p->rate[on->place[i]];
        if (fabs(rate) <= p->straight) {
            times[i] = straight[on->place[i]];
            continue;
        }
        cplx after = heading[++j];
        double angle = carg(after * conj(before));
        int nothing = fabs(angle) <= (on->blurred ? BLUR : HEADING_ROUNDING);
        times[i] = angle / rate;
        unclear += times[i] < 0 && nothing;
        if (times[i] < 0 && (full || !nothing)) times[i] += 2 * PI / fabs(rate);
        before = after;
    }
    return unclear;
}

/* Proposes the candidates with given headings after their turns. */
void propose_headings(Problem *p, const ActiveSet *on, const cplx *heading, const double *straight, cplx m)
{
    double times[MOST];
    int unclear = times_of(p, on, heading, straight, 0, times);
    propose(p, on, times, m);
    if (!unclear) return;
    times_of(p, on, heading, straight, 1, times);
    propose(p, on, times, m);
}
