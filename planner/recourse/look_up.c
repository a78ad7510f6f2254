/* Cost-to-go between nodes. */
#include "recourse.h"

const double NO_SHIFT[5] = {0, 0, 0, 1, 0};

/* The weights of a cell's nodes outside the tolerance, as a flight from outside is never at one inside. */
static double outside_only(const float *low, const float *high, double u, double v, double reached)
{
    double weight[4] = {(1 - u) * (1 - v), (1 - u) * v, u * (1 - v), u * v};
    double value[4] = {low[0], low[1], high[0], high[1]}, sum = 0, all = 0;
    for (int k = 0; k < 4; k++) {
        if (value[k] < 0) continue;
        sum += weight[k] * value[k];
        all += weight[k];
    }
    return all > 0 ? sum / all : reached;
}

/* The grid of a goal position; the last one beyond all. */
int level_of(const Table *t, double x, double y)
{
    double far = greater(fabs(x), fabs(y)), wide = t->step * t->half;
    int level = 0;
    for (; far > wide && level < t->levels - 1; level++) wide *= RATIO;
    return level;
}

double look_up(const Table *t, int trim, double x, double y)
{
    if (t->ends[trim] && x * x + y * y <= t->tolerance * t->tolerance) return 0;
    double beyond = 0, step = t->step;
    int level = level_of(t, x, y);
    for (int k = 0; k < level; k++) step *= RATIO;
    double far = greater(fabs(x), fabs(y)), wide = step * (level == t->levels - 1 ? t->outer : t->half);
    if (far > wide) {
        double share = wide / far;
        beyond = sqrt(x * x + y * y) * (1 - share) / t->best_speed;
        x *= share;
        y *= share;
    }
    int last = 2 * t->half - 1, side = 2 * t->half + 1;
    double u = x / step + t->half, v = y / step + t->half;
    int i = (int)u, j = (int)v;
    if (i > last) i = last;
    if (j > last) j = last;
    u -= i;
    v -= j;
    const float *low = t->value + (((long)trim * t->levels + level) * side + i) * side + j, *high = low + side;
    if (low[0] < 0 || low[1] < 0 || high[0] < 0 || high[1] < 0) return outside_only(low, high, u, v, beyond);
    return beyond + (1 - u) * ((1 - v) * low[0] + v * low[1]) + u * ((1 - v) * high[0] + v * high[1]);
}

/* The share of a chord at which it enters the tolerance; 2 where it does not. */
static double entered(const double *begin, const double *end, double x, double y, double tolerance)
{
    double wx = end[0] - begin[0], wy = end[1] - begin[1], ox = begin[0] - x, oy = begin[1] - y;
    double a = wx * wx + wy * wy, b = ox * wx + oy * wy, c = ox * ox + oy * oy - tolerance * tolerance;
    if (c <= 0) return 0;
    if (b >= 0 || b * b < a * c) return 2;
    double share = (-b - sqrt(b * b - a * c)) / a;
    return share <= 1 ? share : 2;
}

/* Seconds that an action takes, and those that are left after it, on average. A shift moves all its outcomes: s, m
 * forward, m to the right, cosine and sine of the turn; not the path on the way. */
double action_cost(const Table *t, const Actions *p, int action, const double *shift, double x, double y)
{
    int begin = p->outcome[action], end = p->outcome[action + 1], points = p->points[action], to = p->to[action];
    const double *circle = p->circle + 3 * action, *path = p->position + 2L * p->path[action];
    double reach = circle[2] + t->tolerance, sum = 0;
    int near = points && (x - circle[0]) * (x - circle[0]) + (y - circle[1]) * (y - circle[1]) <= reach * reach;
    for (int k = begin; k < end; k++) {
        double share = 2, duration = p->duration[k] + shift[0];
        if (near) {
            const double *point = path + 2L * points * (k - begin);
            for (int n = 0; n < points - 1; n++, point += 2) {
                share = entered(point, point + 2, x, y, t->tolerance);
                if (share > 1) continue;
                sum += duration * (n + share) / (points - 1);
                break;
            }
        }
        if (share <= 1) continue;
        const double *moved = p->displacement + 4L * k;
        double dx = x - moved[0] - shift[1], dy = y - moved[1] - shift[2];
        double cosine = moved[2] * shift[3] - moved[3] * shift[4], sine = moved[3] * shift[3] + moved[2] * shift[4];
        sum += duration + look_up(t, to, cosine * dx + sine * dy, cosine * dy - sine * dx);
    }
    return sum / (end - begin);
}
