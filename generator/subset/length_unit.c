/* SPDX-License-Identifier: MIT
 * The unit of length of a class of subsets: the largest distance of its joints from the bodies' reference points.
 * If joints are much nearer to a reference point than the bodies extend, as of a slider drawn a little beside the
 * point of its coordinate, this distance is accidental, and the unit is the extent of the bodies. */
#include "base/vec3.h"
#include "expression/expression.h"
#include "model/model.h"
#include "subset/subset_private.h"

#include <math.h>

/* Largest distance of a fixture's points from their reference points, over all members; 0 if all coincide but for
 * rounding. */
static double points_reach(const Work *w)
{
    const double rounding = 1e-12;
    double reach = 0, place = 0;
    for (int m = 0; m < w->class->members; ++m)
        for (int b = 0; b < w->first->bodies; ++b)
            place = fmax(place, norm3(w->origin[subset_member(w, m)->body[b]]));
    for (int i = 0; i < w->connections; ++i)
        for (int end = 0; end < 2; ++end) {
            if (w->connection[i].end[end].unknown < 0)
                continue;
            for (int s = 0; s < w->dag->samples; ++s) {
                double s3[3];
                for (int j = 0; j < 3; ++j)
                    s3[j] = ex_value(w->dag, w->connection[i].fixture.point[end][j], s);
                reach = fmax(reach, norm3(s3));
            }
        }
    return reach > rounding * place ? reach : 0;
}

/* Largest extent of the bodies, over all members: distance of the centre of mass from the reference point, and radius
 * of gyration about it. */
static double masses_reach(const Work *w)
{
    double reach = 0;
    for (int m = 0; m < w->class->members; ++m)
        for (int b = 0; b < w->first->bodies; ++b) {
            const int body = subset_member(w, m)->body[b];
            const Body *own = &w->model->body[body];
            const double *inertia = own->inertia, half = 0.5 * (inertia[0] + inertia[1] + inertia[2]);
            double arm[3];
            for (int i = 0; i < 3; ++i)
                arm[i] = own->com[i] - w->origin[body][i];
            reach = fmax(reach, norm3(arm) + (own->mass > 0 && half > 0 ? sqrt(half / own->mass) : 0));
        }
    return reach;
}

double subset_size(const Work *w)
{
    const double near = 1e-2; /* relative to the extent of the bodies */
    const double most = 1;    /* m; a radius of gyration may come from a flywheel and be no measure of length */
    const double points = points_reach(w), masses = masses_reach(w);
    if (!(points > 0))
        return 1;
    return points < near * masses ? fmax(points, fmin(masses, most)) : points;
}

double subset_distance(const Work *w)
{
    double distance = 0, c[3];
    for (int s = 0; s < w->dag->samples; s += w->configurations)
        for (int b = 0; b < w->first->bodies; ++b) {
            for (int i = 0; i < 3; ++i)
                c[i] = ex_value(w->dag, w->pose[b].c[i], s);
            distance = fmax(distance, norm3(c));
        }
    return distance;
}
