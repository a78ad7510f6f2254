/* Motion of a walk under coasting times, and the incumbent times. */
#include "coasting.h"

/* End of the walk, its velocity along each time, and the heading turned by coasting. */
cplx motion(const Problem *p, const double *times, cplx *velocity, double *turned)
{
    cplx position = 0, after[MOST], own[MOST], factor = 1;
    double psi = 0;
    for (int k = 0; k < p->trims; k++) {
        position += factor * p->D[k];
        if (times[k] != 0) {
            double half = 0.5 * p->rate[k] * times[k];
            cplx rotation = unit_complex(half);
            double shrunk = half != 0 ? sin(half) / half : 1.0;
            position += factor * p->W[k] * times[k] * shrunk * rotation;
            factor *= rotation * rotation;
            psi += 2 * half;
        }
        own[k] = factor * p->W[k];
        after[k] = position;
    }
    for (int k = 0; velocity && k < p->trims; k++)
        velocity[k] = own[k] + I * p->rate[k] * (position - after[k]);
    if (turned) *turned = psi;
    return position;
}

/* Replaces the incumbent by faster times that reach the goal; returns whether they reach it. Times that rounding made
 * negative are set to 0. */
int update_best(Problem *p, double *times)
{
    double cost = p->fixed, turned;
    for (int k = 0; k < p->trims; k++) {
        if (!(times[k] * p->speed[k] >= -p->slack && times[k] * fabs(p->rate[k]) >= -p->heading_slack)) return 0;
        if (times[k] < 0) times[k] = 0;
        cost += times[k];
    }
    cplx end = motion(p, times, 0, &turned);
    if (!(cabs(end - p->goal) <= reach(p))) return 0;
    if (p->wants_heading && !(fabs(off_turns(turned - p->heading)) <= p->heading_tolerance + p->heading_slack))
        return 0;
    if (!(cost < p->best)) return 1;
    p->best = cost;
    memcpy(p->times, times, sizeof(double) * (size_t)p->trims);
    return 1;
}
