/* SPDX-License-Identifier: MIT
 *
 * A driver that keeps a speed and follows a path: models/SCENE.md section 5. */
#ifndef SCENE_DRIVER_H
#define SCENE_DRIVER_H

#include "profile_form.h"

#include <stdint.h>

/* A line in the plane as points at equal distances `step` along it, m. */
typedef struct Path {
    int count; /* at least 2 */
    double step, (*point)[2];
    bool closed; /* the last point is the first */
} Path;

/* Measurements of the vehicle for the driver: the origin of the base's body frame, m, and its velocity, m/s, world;
 * yaw, rad, and its rate, rad/s. */
typedef struct Sight {
    double position[3], velocity[3], yaw, yaw_rate;
} Sight;

typedef struct Driver {
    /* from the scene */
    int accelerator, brake;   /* inputs; -1: no speed is kept */
    Profile speed;            /* m/s */
    double gain, integral;    /* 1/s, 1/s^2 */
    double full[2];           /* m/s^2: of full accelerator, of full brake */
    int steering;             /* input; -1: no path is followed */
    bool driven;              /* it is a driven coordinate: rate and acceleration follow */
    Path path;                /* m, world */
    double straight;          /* steering value at the start */
    double middle;            /* steering value straight ahead */
    double per_angle;         /* of the steering over the angle of the front wheels, 1/rad */
    double wheelbase;         /* m */
    double preview, shortest; /* distance of the preview point: s, and least m */
    double limit, adapt;      /* largest steering value off the middle; 1/s, correction of the curvature driven */
    double period, reach;     /* s between looks; s that a movement takes */
    /* during the run */
    int64_t looks; /* number of looks so far */
    double next;   /* time of the next look */
    double speed_sum, curvature_sum, along;
    /* does the vehicle turn as it is steered? the curvature that was steered for at the last look, 1/m; sums of its
     * square, and of its product with the curvature driven */
    double steered, square, product;
    bool seen;
    Movement pedal[2], wheel;
} Driver;

/* What of a driver follows from what it sees: its movements, and what it sums up. */
enum { DRIVE_MOVEMENTS = 3 /* accelerator, brake, steering */, DRIVE_SUMS = 2 /* of speed, of curvature */ };
enum { DRIVE_RESULTS = DRIVE_MOVEMENTS + DRIVE_SUMS, DRIVE_SEEN = 13 /* place and velocities of a free base */ };

/* m/s^2 of deceleration that rolling resistance provides. */
extern const double driver_coast;
/* A point of the path at a distance along it, m; it goes on straight beyond its ends, a closed one repeats. *piece: the
 * point before it. */
void path_point(const Path *path, double along, double out[2], int *piece);
/* driver_slope.c: derivatives of where movements go and of the sums after a look, [3 movements, 2 sums], by what it saw
 * of the state [position, Euler parameters, velocity, angular velocity], and the sums before. before, after: the driver
 * before and after the look at `time`; state, half: as in sight_of(). At limits those of the branch that it takes; by
 * the place along the path those of the nearest point itself, which a look finds to 1 um. */
void driver_look_slope(const Driver *before, const Driver *after, double time, const double *state, int half,
                       double slope[DRIVE_RESULTS][DRIVE_SEEN + DRIVE_SUMS]);

/* The measurements of a base whose pose and velocities are in a state (models/FORMAT.md section 10); half: from a
 * number of the pose's to its rate. */
Sight sight_of(const double *state, int half);
/* Begin at time 0 with pedals free and steering straight. */
void driver_start(Driver *driver);
/* True if a look is due. */
bool driver_is_due(const Driver *driver, double time);
/* The first time after `time` at which its commands are less smooth: the next look, or an earlier end of a movement. */
double driver_next_kink(const Driver *driver, double time);
/* True: over the run the vehicle has turned to the other side than the driver steered for. */
bool driver_is_crossed(const Driver *driver);
/* Decide on new movements. */
void driver_look(Driver *driver, double time, const Sight *sight);
/* Clear the marks of the inputs that it moves. */
void driver_moves(const Driver *driver, bool *fixed);
/* Write its commands into input[]. */
void driver_inputs(const Driver *driver, double time, double *input);

#endif
