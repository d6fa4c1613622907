#include "osi_sensor_view.h"

#include "../protobuf/protobuf.h"

#include <math.h>
#include <string.h>

#define PI 3.141592653589793
#define MM_PER_HOUR 3.6e6 /* in 1 m/s */
#define HOST 0            /* its identifier */
#define LENGTH(list) ((int)(sizeof(list) / sizeof *(list)))

enum { CAR = 1, TRUCK, MOTORCYCLE, BICYCLE, PEDESTRIAN, OBSTACLE };         /* of actor_class */
enum { TYPE_OTHER = 1, TYPE_VEHICLE = 2, TYPE_PEDESTRIAN = 3 };             /* of osi3.MovingObject.Type */
static const uint64_t VEHICLES[] = {[CAR] = 4, [TRUCK] = 7, [MOTORCYCLE] = 10, [BICYCLE] = 11};

/* The base of an object as OSI defines it; a stationary object has only the first three. */
typedef struct {
    double dimension[3], position[3], orientation[3]; /* length, width, height; x, y, z; roll, pitch, yaw */
    double velocity[3], acceleration[3];
} body;

static double within_turn(double angle) { return fabs(angle) <= PI ? angle : remainder(angle, 2 * PI); }

/* A vector along and across a heading, in the world. */
static void turned(double heading, double along, double across, double world[3]) {
    double c = cos(heading), s = sin(heading);
    world[0] = c * along - s * across;
    world[1] = s * along + c * across;
}

static void put_identifier(proto_out *out, uint32_t field, uint64_t value) {
    size_t at = proto_open(out, field);
    proto_put_whole(out, 1, value);
    proto_close(out, at);
}

static void put_type(proto_out *out, uint32_t field, uint64_t type) {
    size_t at = proto_open(out, field);
    proto_put_whole(out, 1, type);
    proto_close(out, at);
}

/* Version and time, at the beginning of every message. */
static void put_head(proto_out *out, int64_t tick) {
    uint64_t nanos = (uint64_t)tick * OSI_STEP_NANOS;
    size_t at = proto_open(out, 1);
    proto_put_whole(out, 1, 3);
    proto_put_whole(out, 2, 8);
    proto_put_whole(out, 3, 0);
    proto_close(out, at);
    at = proto_open(out, 2);
    proto_put_whole(out, 1, nanos / 1000000000);
    proto_put_whole(out, 2, nanos % 1000000000);
    proto_close(out, at);
}

static void put_base(proto_out *out, const body *base, bool moves, const double *yaw_rate) {
    size_t at = proto_open(out, 2);
    proto_put_reals(out, 1, base->dimension, 3);
    proto_put_reals(out, 2, base->position, 3);
    proto_put_reals(out, 3, base->orientation, 3);
    if (moves) proto_put_reals(out, 4, base->velocity, 3);
    if (moves) proto_put_reals(out, 5, base->acceleration, 3);
    if (yaw_rate) {
        double rate[3] = {0, 0, *yaw_rate};
        proto_put_reals(out, 6, rate, 3);
    }
    proto_close(out, at);
}

static bool has_ground(const osi_sensor_view *self) { return self->in.ground[0].friction > 0; }

/* The host's box: its middle *ahead* of the centre of gravity, on the plane of its wheels. */
static body body_of_host(const osi_sensor_view *self, double ahead) {
    double heading = self->in.motion.heading, c = cos(heading), s = sin(heading);
    double rate = self->in.motion.yaw_rate, height = 0, along = 0, across = 0;
    for (int i = 0; i < 4 && has_ground(self); ++i) {
        height += 0.25 * self->in.ground[i].height;
        along += 0.25 * (self->in.ground[i].slope_x * c + self->in.ground[i].slope_y * s);
        across += 0.25 * (self->in.ground[i].slope_y * c - self->in.ground[i].slope_x * s);
    }
    double pitch = -atan(along), roll = atan(across * cos(pitch)), up = 0.5 * self->par.host_height;
    double cp = cos(pitch), sp = sin(pitch), cr = cos(roll), sr = sin(roll);
    body base = {{self->par.host_length, self->par.host_width, self->par.host_height},
                 {0, 0, height - sp * ahead + cp * cr * up},
                 {roll, pitch, within_turn(heading)},
                 {0, 0, 0},
                 {0, 0, 0}};
    turned(heading, cp * ahead + sp * cr * up, -sr * up, base.position);
    base.position[0] += self->in.motion.x;
    base.position[1] += self->in.motion.y;
    turned(heading, self->in.motion.speed, self->in.motion.lateral_speed + rate * ahead, base.velocity);
    turned(heading, self->in.motion.acceleration - rate * rate * ahead, self->in.motion.lateral_acceleration,
           base.acceleration);
    base.velocity[2] = self->in.motion.speed * along + self->in.motion.lateral_speed * across;
    return base;
}

static body body_of(const osi_sensor_view *self, const objects_actor *actor) {
    double ground = has_ground(self) ? actor->z : 0;
    body base = {{actor->length, actor->width, actor->height - actor->clearance},
                 {actor->x, actor->y, ground + 0.5 * (actor->height + actor->clearance)},
                 {0, 0, within_turn(actor->heading)},
                 {0, 0, 0},
                 {0, 0, 0}};
    turned(actor->heading, actor->speed, actor->lateral_speed, base.velocity);
    turned(actor->heading, actor->acceleration, 0, base.acceleration);
    return base;
}

static void put_host(proto_out *out, const osi_sensor_view *self) {
    double ahead = self->par.host_front - 0.5 * self->par.host_length, down = self->par.wheel_radius - 0.5 * self->par.host_height;
    double to_rear[3] = {-self->par.rear_axle - ahead, 0, down}, to_front[3] = {self->par.front_axle - ahead, 0, down};
    body base = body_of_host(self, ahead);
    size_t at = proto_open(out, 5);
    put_identifier(out, 1, HOST);
    put_base(out, &base, true, &self->in.motion.yaw_rate);
    proto_put_whole(out, 3, TYPE_VEHICLE);
    size_t attributes = proto_open(out, 5);
    proto_put_whole(out, 3, 4); /* wheels */
    proto_put_reals(out, 4, to_rear, 3);
    proto_put_reals(out, 5, to_front, 3);
    proto_close(out, attributes);
    put_type(out, 6, VEHICLES[CAR]);
    proto_close(out, at);
}

static void put_mover(proto_out *out, const osi_sensor_view *self, const objects_actor *actor) {
    body base = body_of(self, actor);
    bool is_vehicle = actor->class < PEDESTRIAN;
    size_t at = proto_open(out, 5);
    put_identifier(out, 1, (uint64_t)actor->id);
    put_base(out, &base, true, NULL);
    proto_put_whole(out, 3, is_vehicle ? TYPE_VEHICLE : TYPE_PEDESTRIAN);
    if (is_vehicle) {
        proto_close(out, proto_open(out, 5));
        put_type(out, 6, VEHICLES[actor->class]);
    } else {
        proto_close(out, proto_open(out, 12));
    }
    proto_close(out, at);
}

static void put_obstacle(proto_out *out, const osi_sensor_view *self, const objects_actor *actor) {
    body base = body_of(self, actor);
    size_t at = proto_open(out, 4);
    put_identifier(out, 1, (uint64_t)actor->id);
    put_base(out, &base, false, NULL);
    size_t classified = proto_open(out, 3);
    for (uint32_t field = 1; field <= 3; ++field) proto_put_whole(out, field, TYPE_OTHER); /* type, material, density */
    proto_close(out, classified);
    proto_close(out, at);
}

/* The item of an enumeration with steps that *value* has reached. */
static uint64_t step_of(double value, const double *steps, int count) {
    int reached = 0;
    while (reached < count && value >= steps[reached]) ++reached;
    return (uint64_t)reached;
}

static void put_environment(proto_out *out, const osi_sensor_view *self) {
    static const double RAIN[] = {0.1, 0.5, 1.9, 8.1, 34, 149};                    /* mm/h */
    static const double SIGHT[] = {50, 200, 1000, 2000, 4000, 10000, 40000};       /* m */
    static const double LIGHT[] = {0.01, 1, 3, 10, 20, 400, 1000, 10000};          /* lx */
    double water = (self->in.visibility.rain_rate + self->in.visibility.snow_rate) * MM_PER_HOUR;
    double extinction = self->in.visibility.fog_extinction, light = pow(10, 5 - 8 * self->in.visibility.darkness);
    double sight = extinction > 0 ? -log(0.05) / extinction : HUGE_VAL;
    int64_t seconds = (int64_t)floor(self->par.time_of_day) + self->tick / (1000000000 / OSI_STEP_NANOS);
    size_t at = proto_open(out, 12);
    proto_put_whole(out, 1, 2 + step_of(light, LIGHT, LENGTH(LIGHT)));
    put_type(out, 2, (uint64_t)(seconds % 86400));
    if (self->in.surface.temperature > 0) proto_put_real(out, 4, self->in.surface.temperature);
    proto_put_whole(out, 6, 2 + step_of(water, RAIN, LENGTH(RAIN)));
    proto_put_whole(out, 7, 9 - step_of(sight, SIGHT, LENGTH(SIGHT)));
    proto_close(out, at);
}

static void write_truth(osi_sensor_view *self) {
    proto_out out = {self->out.truth.data, OSI_ROOM, 0};
    put_head(&out, self->tick);
    put_identifier(&out, 3, HOST);
    for (int i = 0; i < OBJECTS_ACTORS; ++i) {
        if (self->in.actors[i].class == OBSTACLE) put_obstacle(&out, self, &self->in.actors[i]);
    }
    put_host(&out, self);
    for (int i = 0; i < OBJECTS_ACTORS; ++i) {
        int32_t class = self->in.actors[i].class;
        if (class >= CAR && class <= PEDESTRIAN) put_mover(&out, self, &self->in.actors[i]);
    }
    put_environment(&out, self);
    self->out.truth.size = out.size;
}

static void write_view(osi_sensor_view *self) {
    proto_out out = {self->out.view.data, OSI_ROOM, 0};
    double position[3] = {self->par.mount + self->par.rear_axle, self->par.mount_left,
                          self->par.mount_height - self->par.wheel_radius};
    double orientation[3] = {0, 0, self->par.mount_turn};
    put_head(&out, self->tick);
    put_identifier(&out, 3, (uint64_t)self->par.sensor_id);
    size_t at = proto_open(&out, 4);
    proto_put_reals(&out, 1, position, 3);
    proto_put_reals(&out, 2, orientation, 3);
    proto_close(&out, at);
    proto_put_bytes(&out, 7, self->out.truth.data, self->out.truth.size);
    put_identifier(&out, 8, HOST);
    self->out.view.size = out.size;
}

static void output(osi_sensor_view *self) {
    osi_pose pose = {self->par.mount, self->par.mount_left, self->par.mount_turn};
    self->out.pose = pose;
    write_truth(self);
    write_view(self);
}

void osi_sensor_view_init(osi_sensor_view *self) {
    self->tick = 0;
    output(self);
    self->tick = -1; /* the first step is at time 0, too */
}

void osi_sensor_view_step(osi_sensor_view *self) {
    ++self->tick;
    output(self);
}
