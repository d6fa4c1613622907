#include "osi_detections.h"

#include "../protobuf/protobuf.h"

#include <math.h>
#include <string.h>

#define LEAST_DEVIATION 1e-6 /* a deviation of 0 means: no measurement */
#define LEAST_ACROSS 1e-3 /* a width of 0 means: unknown */
#define INVALID 2            /* of osi3.DetectionClassification */
#define STATIONARY_OBJECT 11 /* fields of SensorData */
#define MOVING_OBJECT 13
#define FEATURE_DATA 26

enum { NONE, CAR, TRUCK, MOTORCYCLE, BICYCLE, PEDESTRIAN, OBSTACLE }; /* of actor_class */
enum { X, Y, Z };

/* Of osi3.MovingObject.VehicleClassification.Type; other, watercraft and similar types become NONE. */
static const uint8_t VEHICLES[] = {NONE,  NONE,  CAR,   CAR,        CAR,     CAR,   CAR,     TRUCK,      TRUCK, TRUCK,
                                   MOTORCYCLE, BICYCLE, TRUCK, TRUCK, TRUCK, PEDESTRIAN, TRUCK, BICYCLE, PEDESTRIAN, TRUCK};

/* A base of osi3, in the frame of the sensor. */
typedef struct {
    double dimension[3], position[3], orientation[3], velocity[3];
} base;

typedef struct {
    base is, rmse;
    double existence;
    bool has_velocity, has_rmse;
    int32_t class;
    double probability; /* of the class */
} object;

typedef struct {
    double existence, place[3], rmse[3]; /* distance, azimuth, elevation */
    double rate, rate_rmse, snr;         /* NaN: not given */
    bool is_invalid;
} reflex;

/* The content of a message that is not validated yet. */
typedef struct {
    objects_detection returns[OBJECTS_RETURNS];
    int32_t count, left_out;
    int64_t timestamp, measured;
} reading;

static uint64_t identifier_or_type(proto_in in) {
    proto_field field;
    uint64_t value = 0;
    while (proto_next(&in, &field)) {
        if (proto_is(&field, 1, PROTO_WHOLE)) value = field.whole;
    }
    return value;
}

/* In ns; -1 for an invalid time. */
static int64_t time_of(proto_in in) {
    proto_field field;
    uint64_t seconds = 0, nanos = 0;
    while (proto_next(&in, &field)) {
        if (proto_is(&field, 1, PROTO_WHOLE)) seconds = field.whole;
        if (proto_is(&field, 2, PROTO_WHOLE)) nanos = field.whole;
    }
    return seconds < 1000000000 && nanos < 1000000000 ? (int64_t)(seconds * 1000000000 + nanos) : -1;
}

static void read_base(proto_in in, base *into, bool *has_velocity) {
    proto_field field;
    while (proto_next(&in, &field)) {
        if (proto_is(&field, 1, PROTO_BYTES)) proto_reals(field.bytes, into->dimension, 3);
        if (proto_is(&field, 2, PROTO_BYTES)) proto_reals(field.bytes, into->position, 3);
        if (proto_is(&field, 3, PROTO_BYTES)) proto_reals(field.bytes, into->orientation, 3);
        if (proto_is(&field, 4, PROTO_BYTES)) {
            *has_velocity = true;
            proto_reals(field.bytes, into->velocity, 3);
        }
    }
}

static void read_header(proto_in in, object *into) {
    proto_field field;
    while (proto_next(&in, &field)) {
        if (proto_is(&field, 3, PROTO_REAL)) into->existence = field.real;
    }
}

static void read_candidate(proto_in in, object *into) {
    proto_field field;
    double probability = 0;
    uint64_t type = 0, vehicle = 0;
    while (proto_next(&in, &field)) {
        if (proto_is(&field, 1, PROTO_REAL)) probability = field.real;
        if (proto_is(&field, 2, PROTO_WHOLE)) type = field.whole;
        if (proto_is(&field, 3, PROTO_BYTES)) vehicle = identifier_or_type(field.bytes);
    }
    if (!(probability > into->probability)) return;
    into->probability = probability;
    into->class = type == 2 && vehicle < sizeof VEHICLES ? VEHICLES[vehicle] : type == 3 ? PEDESTRIAN : type == 4 ? OBSTACLE : NONE;
}

static object read_object(proto_in in, bool moves) {
    object found;
    bool of_rmse = false;
    proto_field field;
    memset(&found, 0, sizeof found);
    found.existence = 1;
    while (proto_next(&in, &field)) {
        if (proto_is(&field, 1, PROTO_BYTES)) read_header(field.bytes, &found);
        if (proto_is(&field, 2, PROTO_BYTES)) read_base(field.bytes, &found.is, &found.has_velocity);
        if (proto_is(&field, 3, PROTO_BYTES)) {
            found.has_rmse = true;
            read_base(field.bytes, &found.rmse, &of_rmse);
        }
        if (moves && proto_is(&field, 8, PROTO_BYTES)) read_candidate(field.bytes, &found);
    }
    if (!moves) found.class = OBSTACLE;
    found.has_velocity = found.has_velocity && moves; /* stationary objects have other fields there */
    return found;
}

static reflex read_reflex(proto_in in, osi_takes takes) {
    reflex found = {1, {0, 0, 0}, {0, 0, 0}, NAN, 0, NAN, false};
    proto_field field;
    while (proto_next(&in, &field)) {
        if (proto_is(&field, 1, PROTO_REAL)) found.existence = field.real;
        if (proto_is(&field, 3, PROTO_BYTES)) proto_reals(field.bytes, found.place, 3);
        if (proto_is(&field, 4, PROTO_BYTES)) proto_reals(field.bytes, found.rmse, 3);
        if (proto_is(&field, takes == OSI_RADAR ? 5 : 12, PROTO_REAL)) found.rate = -field.real;
        if (takes == OSI_RADAR && proto_is(&field, 6, PROTO_REAL)) found.rate_rmse = field.real;
        if (takes == OSI_RADAR && proto_is(&field, 8, PROTO_REAL)) found.snr = field.real;
        if (proto_is(&field, takes == OSI_RADAR ? 11 : 9, PROTO_WHOLE)) found.is_invalid = field.whole == INVALID;
    }
    return found;
}

/* Converts a place from the sensor's axes to those of pose.ahead, along the car; false if it is invalid. */
static bool place(const osi_pose *mount, double x, double y, objects_detection *told) {
    double c = cos(mount->turn), s = sin(mount->turn), ahead = c * x - s * y, left = s * x + c * y + mount->left;
    told->range = sqrt(ahead * ahead + left * left);
    told->azimuth = atan2(left, ahead);
    return isfinite(told->range) && told->range > 0;
}

/* The side that is reported: its middle, the angle that it fills, and the share of it across the car's axis. */
typedef struct {
    double x, y, angle, across;
} side;

static side side_of(const base *box, double turn) {
    double c = cos(box->orientation[2]), s = sin(box->orientation[2]);
    side told = {box->position[X], box->position[Y], 0, 0};
    for (int i = 0; i < 4 && box->dimension[0] > 0 && box->dimension[1] > 0; ++i) {
        double sign = i < 2 ? 1 : -1, out = 0.5 * box->dimension[i % 2], half = 0.5 * box->dimension[1 - i % 2];
        double nx = sign * (i % 2 ? -s : c), ny = sign * (i % 2 ? c : s);
        double mx = box->position[X] + out * nx, my = box->position[Y] + out * ny;
        double ax = mx - half * ny, ay = my + half * nx, bx = mx + half * ny, by = my - half * nx;
        double fills = fabs(atan2(ax * by - ay * bx, ax * bx + ay * by));
        if (!(nx * mx + ny * my < 0 && fills > told.angle)) continue; /* it faces away, or another side covers more */
        side found = {mx, my, fills, fmax(fabs(nx * cos(turn) - ny * sin(turn)), LEAST_ACROSS)};
        told = found;
    }
    return told;
}

static double at_least(double deviation, double otherwise) {
    return fmax(isfinite(deviation) && deviation > 0 ? deviation : otherwise, LEAST_DEVIATION);
}

static bool tell_object(const osi_detections *self, const object *found, objects_detection *told) {
    const osi_pose *mount = &self->in.pose;
    side seen = side_of(&found->is, mount->turn);
    double x = seen.x, y = seen.y;
    if (!isfinite(x) || !isfinite(y) || !place(mount, x, y, told)) return false;
    double range = sqrt(x * x + y * y);
    if (!(range > 0)) return false;
    double cx = x / range, cy = y / range, sx = found->rmse.position[X], sy = found->rmse.position[Y];
    told->class = found->class;
    told->width = 2 * range * seen.across * tan(0.5 * seen.angle);
    told->range_deviation = at_least(found->has_rmse ? sqrt(cx * cx * sx * sx + cy * cy * sy * sy) : 0, self->par.range_deviation);
    told->azimuth_deviation =
        at_least(found->has_rmse ? sqrt(cy * cy * sx * sx + cx * cx * sy * sy) / range : 0, self->par.azimuth_deviation);
    if (!found->has_velocity) return isfinite(told->width);
    double vx = found->rmse.velocity[X], vy = found->rmse.velocity[Y];
    told->range_rate = cx * found->is.velocity[X] + cy * found->is.velocity[Y];
    told->rate_deviation = at_least(found->has_rmse ? sqrt(cx * cx * vx * vx + cy * cy * vy * vy) : 0, self->par.rate_deviation);
    return isfinite(told->range_rate) && isfinite(told->width);
}

static bool tell_reflex(const osi_detections *self, const reflex *found, objects_detection *told) {
    double flat = found->place[0] * cos(found->place[2]);
    if (!place(&self->in.pose, flat * cos(found->place[1]), flat * sin(found->place[1]), told)) return false;
    told->range_deviation = at_least(found->rmse[0], self->par.range_deviation);
    told->azimuth_deviation = at_least(found->rmse[1], self->par.azimuth_deviation);
    if (!isnan(found->snr)) told->strength = pow(10, found->snr / 10);
    if (isnan(found->rate)) return isfinite(told->strength);
    told->range_rate = found->rate;
    told->rate_deviation = at_least(found->rate_rmse, self->par.rate_deviation);
    return isfinite(told->range_rate) && isfinite(told->strength);
}

/* Nearest first. */
static void keep(reading *into, objects_detection told) {
    bool is_full = into->count == OBJECTS_RETURNS;
    if (is_full) ++into->left_out;
    if (is_full && !(told.range < into->returns[OBJECTS_RETURNS - 1].range)) return;
    int32_t at = is_full ? OBJECTS_RETURNS - 1 : into->count++;
    for (; at > 0 && into->returns[at - 1].range > told.range; --at) into->returns[at] = into->returns[at - 1];
    into->returns[at] = told;
    into->returns[at].valid = true;
}

/* *exists*, which may be NaN, decides whether it is reported. */
static void take(const osi_detections *self, reading *into, double exists, bool is_told, const objects_detection *told) {
    if (exists < self->par.least_existence) return;
    if (is_told && !isnan(exists)) keep(into, *told);
    else ++into->left_out;
}

static void read_objects(const osi_detections *self, proto_in in, bool moves, reading *into) {
    objects_detection told = {false, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    object found = read_object(in, moves);
    bool is_told = tell_object(self, &found, &told);
    take(self, into, found.existence, is_told, &told);
}

static void read_reflexes(const osi_detections *self, proto_in in, osi_takes takes, reading *into) {
    proto_field field;
    while (proto_next(&in, &field)) {
        if (!proto_is(&field, 2, PROTO_BYTES)) continue;
        objects_detection told = {false, 0, 0, 0, 0, 0, 0, 0, 0, 0};
        reflex found = read_reflex(field.bytes, takes);
        bool is_told = tell_reflex(self, &found, &told);
        if (!found.is_invalid) take(self, into, found.existence, is_told, &told);
    }
}

static void read_features(const osi_detections *self, proto_in in, osi_takes takes, reading *into) {
    proto_field field;
    while (proto_next(&in, &field)) {
        if (proto_is(&field, takes == OSI_RADAR ? 2 : 3, PROTO_BYTES)) read_reflexes(self, field.bytes, takes, into);
    }
}

static bool read_data(const osi_detections *self, reading *into) {
    bool broken = self->in.data.size > OSI_DATA_ROOM;
    proto_in in = {self->in.data.data, self->in.data.data + (broken ? 0 : self->in.data.size), &broken};
    osi_takes takes = (osi_takes)self->par.takes;
    proto_field field;
    memset(into, 0, sizeof *into);
    into->timestamp = into->measured = -1;
    while (proto_next(&in, &field)) {
        if (proto_is(&field, 2, PROTO_BYTES)) into->timestamp = time_of(field.bytes);
        if (proto_is(&field, 9, PROTO_BYTES)) into->measured = time_of(field.bytes);
        bool is_object = proto_is(&field, MOVING_OBJECT, PROTO_BYTES) || proto_is(&field, STATIONARY_OBJECT, PROTO_BYTES);
        if (takes == OSI_OBJECTS && is_object) read_objects(self, field.bytes, field.number == MOVING_OBJECT, into);
        if (takes != OSI_OBJECTS && proto_is(&field, FEATURE_DATA, PROTO_BYTES)) {
            read_features(self, field.bytes, takes, into);
        }
    }
    return !broken;
}

static void tell(osi_detections *self, const reading *read) {
    int64_t measured = read->measured >= 0 ? read->measured : read->timestamp;
    ++self->out.messages;
    if (self->out.scan.number == 0 || measured < 0 || measured != self->measured) {
        ++self->out.scan.number;
        self->out.left_out += read->left_out;
        memcpy(self->out.scan.returns, read->returns, sizeof self->out.scan.returns);
        self->measured = measured >= 0 ? measured : self->tick * OSI_STEP_NANOS;
    }
}

static void read(osi_detections *self) {
    reading found;
    self->out.scan.mount = self->in.pose.ahead;
    if (self->in.data.size > 0) {
        if (read_data(self, &found)) tell(self, &found);
        else ++self->out.malformed;
    }
    if (self->out.scan.number > 0) self->out.scan.age = fmax((double)(self->tick * OSI_STEP_NANOS - self->measured) / 1e9, 0);
}

static void restart(osi_detections *self) {
    memset(&self->out, 0, sizeof self->out);
    self->measured = -1;
}

void osi_detections_init(osi_detections *self) {
    restart(self);
    self->tick = 0;
    read(self);
    self->tick = -1; /* the first step is at time 0, too */
}

void osi_detections_step(osi_detections *self) {
    if (++self->tick == 0) restart(self);
    read(self);
}
