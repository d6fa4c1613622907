#include "ray_scanner.h"

#include <math.h>

#include "../../road_users/in_the_way.h"

/* A box seen from the middle of the host's front bumper: ahead and to the left. */
typedef struct {
    double x, y, cosine, sine; /* of its middle; of its heading relative to the host's */
    double length, width;      /* halves */
    double vx, vy;             /* relative to the bumper */
} seen_box;

typedef struct {
    double range, azimuth, closing_speed;
    bool hit;
} echo;

static double azimuth(const ray_scanner *self, int32_t ray) {
    return (ray - 0.5 * (self->count - 1)) * self->spacing;
}

static void aim(ray_scanner *self) {
    int32_t wanted = self->par.ray_count;
    self->count = wanted < 0 ? 0 : wanted > RAY_SCANNER_RAYS ? RAY_SCANNER_RAYS : wanted;
    self->spacing = self->count > 1 ? self->par.ray_angle / (self->count - 1) : 0;
    for (int32_t i = 0; i < self->count; ++i) {
        self->rays[i].x = cos(azimuth(self, i));
        self->rays[i].y = sin(azimuth(self, i));
    }
}

static seen_box see(const ray_scanner *self, const ray_scanner_actor *actor, double c, double s) {
    double front = self->par.host_front, turned = actor->heading - self->in.motion.heading;
    double dx = actor->x - self->in.motion.x, dy = actor->y - self->in.motion.y;
    seen_box box = {
        .x = c * dx + s * dy - front,
        .y = c * dy - s * dx,
        .cosine = cos(turned),
        .sine = sin(turned),
        .length = 0.5 * actor->length,
        .width = 0.5 * actor->width,
    };
    box.vx = actor->speed * box.cosine - actor->lateral_speed * box.sine - self->in.motion.speed;
    box.vy = actor->speed * box.sine + actor->lateral_speed * box.cosine - self->in.motion.lateral_speed -
             self->in.motion.yaw_rate * front;
    return box;
}

/* The part of a ray between two parallel sides, as distances along it: *from* is the origin's place across them. */
static void between(double from, double along, double half, double *in, double *out) {
    if (fabs(along) < 1e-200) { /* its inverse would be nearly infinite: the ray stays at its place */
        if (fabs(from) > half) *in = HUGE_VAL;
        return;
    }
    double per = 1 / along, middle = -from * per, reach = half * fabs(per);
    if (middle - reach > *in) *in = middle - reach;
    if (middle + reach < *out) *out = middle + reach;
}

/* The rays from *first* to *last* that may meet the box: those within the angle that its corners span. */
static void narrow(const ray_scanner *self, const seen_box *box, int32_t *first, int32_t *last) {
    double ax = box->cosine * box->length, ay = box->sine * box->length;
    double bx = -box->sine * box->width, by = box->cosine * box->width;
    double right = HUGE_VAL, left = -HUGE_VAL;
    for (int32_t i = 0; i < 4; ++i) {
        double x = box->x + (i & 1 ? ax : -ax) + (i & 2 ? bx : -bx);
        double y = box->y + (i & 1 ? ay : -ay) + (i & 2 ? by : -by);
        if (!(x > 0)) return; /* beside the bumper: all rays are tested */
        double slope = y / x;
        if (slope < right) right = slope;
        if (slope > left) left = slope;
    }
    /* The fan spans at most half a turn: its rays are in the order of their slopes. */
    int32_t low = *first, high = *last + 1;
    while (low < high) {
        int32_t middle = (low + high) / 2;
        if (self->rays[middle].y < right * self->rays[middle].x) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    *first = low;
    while (high <= *last && self->rays[high].y <= left * self->rays[high].x) ++high;
    *last = high - 1;
}

static void cast(const ray_scanner *self, const seen_box *box, echo *nearest) {
    double distance = sqrt(box->x * box->x + box->y * box->y);
    if (distance - box->length - box->width > nearest->range) return;
    int32_t first = 0, last = self->count - 1;
    narrow(self, box, &first, &last);
    /* The bumper's place, and each ray, along the box and across it. */
    double along = -box->cosine * box->x - box->sine * box->y, across = box->sine * box->x - box->cosine * box->y;
    for (int32_t i = first; i <= last; ++i) {
        double in = 0, out = HUGE_VAL, x = self->rays[i].x, y = self->rays[i].y;
        between(along, box->cosine * x + box->sine * y, box->length, &in, &out);
        between(across, box->cosine * y - box->sine * x, box->width, &in, &out);
        if (in > out || !(in < nearest->range || (in == nearest->range && !nearest->hit))) continue;
        nearest->range = in;
        nearest->azimuth = azimuth(self, i);
        nearest->closing_speed = -(box->vx * x + box->vy * y);
        nearest->hit = true;
    }
}

/* Separating axes: boxes are apart if their projections on a side of one of them are apart. */
static bool touches(const ray_scanner *self, const seen_box *box) {
    double length = 0.5 * self->par.host_length, width = 0.5 * self->par.host_width;
    double x = box->x + length, y = box->y, c = fabs(box->cosine), s = fabs(box->sine); /* from the host's middle */
    if (fabs(x) > length + c * box->length + s * box->width) return false;
    if (fabs(y) > width + s * box->length + c * box->width) return false;
    double along = box->cosine * x + box->sine * y, across = box->cosine * y - box->sine * x;
    if (fabs(along) > box->length + c * length + s * width) return false;
    return !(fabs(across) > box->width + s * length + c * width);
}

static void output(ray_scanner *self) {
    double c = cos(self->in.motion.heading), s = sin(self->in.motion.heading);
    echo nearest = {self->par.ray_reach, 0, 0, false};
    double gap = self->par.ray_reach;
    const ray_scanner_actor *lead = 0;
    for (int32_t i = 0; i < RAY_SCANNER_ACTORS; ++i) {
        const ray_scanner_actor *actor = &self->in.actors[i];
        if (actor->class == 0 || !in_the_way(actor->above, actor->clearance, actor->height, self->par.ground_clearance,
                                             self->par.host_height)) {
            continue;
        }
        seen_box box = see(self, actor, c, s);
        cast(self, &box, &nearest);
        if (touches(self, &box)) self->out.collision = true;
        double between_bumpers = actor->ahead - self->par.host_front - 0.5 * actor->length;
        if (actor->ahead > 0 && fabs(actor->aside) < 0.5 * self->in.lane.width && (between_bumpers < gap)) {
            gap = between_bumpers;
            lead = actor;
        }
    }
    self->out.scene.range = nearest.range;
    self->out.scene.azimuth = nearest.azimuth;
    self->out.scene.closing_speed = nearest.closing_speed;
    self->out.scene.hit = nearest.hit;
    self->out.gap = gap;
    self->out.closing_speed = lead ? lead->approach : 0;
    self->out.lead.speed = lead ? lead->speed : 0;
    self->out.lead.id = lead ? lead->id : 0;
}

void ray_scanner_init(ray_scanner *self) {
    aim(self);
    self->out.collision = false;
    output(self);
}

void ray_scanner_step(ray_scanner *self, double h) {
    (void)h;
    output(self);
}
