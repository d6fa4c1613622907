#include "objects.h"

#include "../../road_users/in_the_way.h"
#include "../sensing/sensing.h"
#include "view.h"

#include <math.h>
#include <string.h>

#define PI 3.141592653589793
#define DRAWN 5                   /* uniform numbers of one noise */
#define GHOSTS (3 * OBJECTS_ACTORS) /* objects, their images in a rail, their double bounces */
#define FOUND (GHOSTS + OBJECTS_ACTORS) /* and their spray */
#define SPRAY (1 << 30)           /* its noise: numbers that no scan of a run comes to */
#define SPRAY_SPEED (100 / 3.6)   /* m/s: as much spray as there can be */
#define TRUCK 2                   /* of actor_class */
#define AHEAD (UINT64_C(1) << 40) /* numbers between those of the noise and those of bias and drift */
#define FLAT 0.1                  /* m: an object of this height hides nothing */
#define LEAST_RATE_DEVIATION 1e-3 /* m/s */

/* Standard normal numbers; a uniform one follows them. */
typedef struct {
    double range, azimuth, doppler, elevation;
} noise;

static noise draw(uint64_t *state) {
    sensing_pair place = sensing_normal(state), rate = sensing_normal(state);
    noise drawn = {place.first, place.second, rate.first, rate.second};
    return drawn;
}

static double reflection(const objects *self, int32_t class) {
    double of[OBJECTS_CLASSES] = {0,
                                  self->par.car,
                                  self->par.truck,
                                  self->par.motorcycle,
                                  self->par.bicycle,
                                  self->par.pedestrian,
                                  self->par.obstacle};
    return class > 0 && class < OBJECTS_CLASSES ? of[class] : 0;
}

/* Where the sensor looks in the plane of the world. */
static double direction(const objects *self) { return self->in.motion.heading + self->par.mount_turn; }

/* Attenuation of light or a wave, 1/m, one way. */
static double lost(const objects *self) {
    return self->par.fog_share * self->in.visibility.fog_extinction +
           sensing_attenuation(self->in.visibility.rain_rate, self->par.rain_loss, self->par.rain_exponent) +
           sensing_attenuation(self->in.visibility.snow_rate, self->par.snow_loss, self->par.snow_exponent);
}

/* Signal to noise of an object at *range*, *share* of which is seen; 0: beyond the range of a camera. */
static double strength(const objects *self, double reflected, double share, double range, double loss) {
    if (self->par.echo_exponent > 0) {
        double relative = reflected / self->par.car * share * pow(self->par.max_range / range, self->par.echo_exponent);
        return self->par.threshold * relative * exp(-2 * loss * range);
    }
    double reach = self->par.max_range, dark = self->in.visibility.darkness;
    if (dark > 0 && self->par.night_range > 0 && self->par.night_range < reach) {
        reach += fmin(dark, 1) * (self->par.night_range - reach);
    }
    if (range > reach) return 0;
    double veil = sensing_veil(self->in.sun.azimuth - direction(self), self->in.sun.elevation, self->in.sun.glare);
    double contrast = self->par.contrast > 0 ? exp(-loss * range) / ((1 + veil) * self->par.contrast) : 1;
    if (reflected > 0) contrast *= reflected;
    return self->par.threshold * contrast * contrast;
}

/* Narrows a part to the beams of the grid that meet it; false: no beam meets it. */
static bool beams_meet(const objects *self, view_part *part) {
    double spacing = self->par.beam_spacing;
    if (!(spacing > 0)) return true;
    part->right = ceil(part->right / spacing) * spacing;
    part->left = floor(part->left / spacing) * spacing;
    return part->right <= part->left;
}

static bool layers_meet(const objects *self, const objects_actor *actor, double range) {
    if (!(self->par.layer_spacing > 0)) return true;
    for (int32_t i = 0; i < self->par.layers; ++i) {
        double above = self->par.mount_height + range * tan((i - 0.5 * (self->par.layers - 1)) * self->par.layer_spacing);
        if (above >= actor->clearance && above <= actor->height) return true;
    }
    return false;
}

/* The object is large enough in the image. */
static bool pixels_meet(const objects *self, const objects_actor *actor, const view_part *part, double range) {
    double across = 2 * part->across * tan(0.5 * (part->left - part->right)); /* at a range of 1 m */
    double high = (actor->height - actor->clearance) / range;
    return !(self->par.least_pixels > 0) ||
           self->par.focal_length * fmin(across, high) >= self->par.least_pixels;
}

/* Share of the power that a radar's lobe leaves, there and back, to the part of an object nearest to its axis. */
static double lobe(const objects *self, const objects_actor *actor, double range) {
    double above = fmax(actor->clearance - self->par.mount_height, 0), below = fmax(self->par.mount_height - actor->height, 0);
    if (!(self->par.elevation_beam > 0) || !(above + below > 0)) return 1;
    double beams = atan((above + below) / range) / self->par.elevation_beam;
    return exp(-8 * log(2) * beams * beams);
}

/* By its measured height an object is not in the way. */
static bool is_passable(const objects *self, const objects_actor *actor, double range, double normal) {
    double error = range * self->par.elevation_noise * normal;
    return (self->par.least_clearance > 0 && actor->clearance + error > self->par.least_clearance) ||
           (self->par.least_height > 0 && actor->height + error < self->par.least_height);
}

/* Range rate of an object that moves over ground with *vx* along the sensor's axis and *vy* to its left. */
static double rate(const objects *self, double vx, double vy, const view_part *part, double range) {
    double c = cos(self->par.mount_turn), s = sin(self->par.mount_turn), turning = self->in.motion.yaw_rate;
    double along = self->in.motion.speed - turning * self->par.mount_left;
    double aside = self->in.motion.lateral_speed + turning * self->par.mount;
    return ((vx - (c * along + s * aside)) * part->x + (vy - (c * aside - s * along)) * part->y) / range;
}

/* The detection of one object, without noise; valid if it is detected. */
static objects_detection detected(const objects *self, const objects_actor *actor, view_part part, double loss) {
    objects_detection told = {false, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    if (!(part.share > 0) || part.share < self->par.min_visible || !beams_meet(self, &part)) return told;
    double range = sqrt(part.x * part.x + part.y * part.y);
    if (!(range > 0) || !layers_meet(self, actor, range) || !pixels_meet(self, actor, &part, range)) return told;
    told.strength = strength(self, reflection(self, actor->class), part.share * lobe(self, actor, range), range, loss);
    told.valid = told.strength > 0 && told.strength >= self->par.threshold;
    told.range = range;
    told.azimuth = atan2(part.y, part.x);
    if (self->par.doppler) {
        double turned = actor->heading - direction(self), c = cos(turned), s = sin(turned);
        double vx = actor->speed * c - actor->lateral_speed * s, vy = actor->speed * s + actor->lateral_speed * c;
        told.range_rate = rate(self, vx, vy, &part, range);
    }
    if (self->par.tells_class) told.class = actor->class;
    if (self->par.tells_width) told.width = 2 * part.across * tan(0.5 * (part.left - part.right)); /* at a range of 1 m */
    return told;
}

/* The reflection of an object in the guard rail, as a detection; not valid if there is none. */
static objects_detection mirrored(const objects *self, const objects_actor *actor, view_part part, double loss) {
    objects_detection told = {false, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    double turned = self->in.lane.heading, left = self->par.mount_left * cos(turned) + self->par.mount * sin(turned);
    double nx = sin(turned + self->par.mount_turn), ny = cos(turned + self->par.mount_turn); /* to the left of the lane */
    double rail = self->par.rail - self->in.lane.offset - left, beyond = rail - nx * part.x - ny * part.y;
    if (!(rail * beyond > 0)) return told; /* behind the rail */
    view_part image = part;
    image.x += 2 * beyond * nx;
    image.y += 2 * beyond * ny;
    told.range = sqrt(image.x * image.x + image.y * image.y);
    told.azimuth = atan2(image.y, image.x);
    told.strength = self->par.rail_reflection * self->par.rail_reflection *
                    strength(self, reflection(self, actor->class), part.share, told.range, loss);
    told.valid = told.strength >= self->par.threshold && fabs(told.azimuth) < 0.5 * self->par.field_of_view;
    if (!self->par.doppler) return told;
    double turn = actor->heading - direction(self), c = cos(turn), s = sin(turn);
    double vx = actor->speed * c - actor->lateral_speed * s, vy = actor->speed * s + actor->lateral_speed * c;
    double towards = nx * vx + ny * vy;
    told.range_rate = rate(self, vx - 2 * towards * nx, vy - 2 * towards * ny, &image, told.range);
    return told;
}

/* An echo that was reflected by the object a second time. */
static objects_detection bounced(const objects *self, const objects_actor *actor, objects_detection told, double share, double loss) {
    double sphere = 4 * PI * told.range * told.range, reflected = reflection(self, actor->class) * share;
    told.strength *= reflected * self->par.own_reflection / (sphere * sphere) * exp(-2 * loss * told.range);
    told.valid = told.strength >= self->par.threshold;
    told.range *= 2;
    told.range_rate *= 2;
    return told;
}

/* How much spray there is before a truck that drives ahead, 0 to 1. */
static double spray(const objects *self, const objects_actor *actor) {
    double share = actor->speed / SPRAY_SPEED;
    bool is_there = actor->class == TRUCK && self->in.visibility.rain_rate > 0;
    return is_there && cos(actor->heading - direction(self)) > 0 ? fmin(share * share, 1) : 0;
}

static bool one_cell(const objects *self, const objects_detection *a, const objects_detection *b) {
    return fabs(a->range - b->range) < self->par.range_cell && fabs(a->azimuth - b->azimuth) < self->par.azimuth_cell &&
           (!self->par.doppler || fabs(a->range_rate - b->range_rate) < self->par.doppler_cell);
}

/* Strongest first, each absorbs the weaker ones of its cell. */
static void merge(const objects *self, objects_detection *found, int32_t count) {
    bool done[FOUND] = {false};
    for (;;) {
        int32_t top = -1;
        for (int32_t i = 0; i < count; ++i) {
            if (found[i].valid && !done[i] && (top < 0 || found[i].strength > found[top].strength)) top = i;
        }
        if (top < 0) return;
        objects_detection first = found[top], *sum = &found[top];
        done[top] = true;
        for (int32_t i = 0; i < count; ++i) {
            if (!found[i].valid || done[i] || !one_cell(self, &first, &found[i])) continue;
            double weight = found[i].strength / (sum->strength + found[i].strength);
            sum->range += weight * (found[i].range - sum->range);
            sum->azimuth += weight * (found[i].azimuth - sum->azimuth);
            sum->range_rate += weight * (found[i].range_rate - sum->range_rate);
            sum->strength += found[i].strength;
            found[i].valid = false;
        }
    }
}

static double range_deviation(const objects *self, double range) {
    double relative = self->par.relative_noise * range, eyes = self->par.focal_length * self->par.baseline;
    double stereo = eyes > 0 ? self->par.disparity_noise * range * range / eyes : 0;
    return sqrt(self->par.range_noise * self->par.range_noise + relative * relative + stereo * stereo);
}

static void disturb(const objects *self, objects_detection *told, const noise *drawn) {
    double scale = 1 + self->bias.scale + self->drift.scale, turn = self->bias.azimuth + self->drift.azimuth;
    told->range = fmax(told->range * scale + range_deviation(self, told->range) * drawn->range, 0);
    told->azimuth += turn + self->par.azimuth_noise * drawn->azimuth;
    if (self->par.doppler) told->range_rate += self->par.doppler_noise * drawn->doppler;
    told->width *= told->range;
    told->range_deviation = range_deviation(self, told->range);
    told->azimuth_deviation = self->par.azimuth_noise;
    told->rate_deviation = self->par.doppler ? fmax(self->par.doppler_noise, LEAST_RATE_DEVIATION) : 0;
}

/* The numbers of object, image or bounce *number* of this scan, independent of other seen objects. */
static noise noise_of(const objects *self, int32_t number) {
    uint64_t state = self->random;
    sensing_skip(&state, (uint64_t)number * DRAWN);
    return draw(&state);
}

static double uniform_of(const objects *self, int32_t number) {
    uint64_t state = self->random;
    sensing_skip(&state, (uint64_t)number * DRAWN + DRAWN - 1);
    return sensing_uniform(&state);
}

/* Bias and drift of this scan. */
static void drift(objects *self) {
    bool is_first = self->tick == 0;
    double fade = is_first || !(self->par.correlation_time > 0) ? 0 : exp(-self->par.period / self->par.correlation_time);
    if (is_first) {
        sensing_pair drawn = sensing_normal(&self->slow);
        self->bias.scale = self->par.scale_bias * drawn.first;
        self->bias.azimuth = self->par.azimuth_bias * drawn.second;
    }
    sensing_pair drawn = sensing_normal(&self->slow);
    self->drift.scale = sensing_drifted(self->drift.scale, self->par.scale_drift, fade, drawn.first);
    self->drift.azimuth = sensing_drifted(self->drift.azimuth, self->par.azimuth_drift, fade, drawn.second);
}

/* What a bias and a drift are together. */
static objects_lasting lasting(double bias, double drift, double correlation_time) {
    double variance = bias * bias + drift * drift;
    objects_lasting told = {sqrt(variance), drift > 0 ? variance / (drift * drift) * correlation_time : 0};
    return told;
}

/* Object *i* is lost in this scan: the next state of its chain. */
static bool is_lost(objects *self, int32_t i) {
    double share = self->par.dropout, scans = self->par.dropout_time / self->par.period, chance = share;
    if (self->tick > 0 && scans * (1 - share) > 1) {
        chance = self->is_lost[i] ? 1 - 1 / scans : share / (scans * (1 - share));
    }
    self->is_lost[i] = uniform_of(self, i) <= chance;
    return self->is_lost[i];
}

/* The next place of the patch of spray behind a truck, m behind it; negative: there is none. */
static double drifted(const objects *self, int32_t i, double amount) {
    double place = self->patch[i];
    if (!(amount > 0)) return -1;
    if (place < 0) return uniform_of(self, SPRAY + GHOSTS + i) <= self->par.spray_share * amount ? 0 : -1;
    place += self->par.spray_drift * self->in.actors[i].speed * self->par.period;
    return place <= self->par.spray_length ? place : -1;
}

/* Spray hides the truck, and a patch of it may be seen as an object that is left behind. */
static void spray_of(objects *self, objects_detection found[FOUND]) {
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) {
        const objects_actor *actor = &self->in.actors[i];
        double amount = spray(self, actor);
        self->patch[i] = drifted(self, i, amount);
        if (!found[i].valid || !(amount > 0)) continue;
        objects_detection *patch = &found[GHOSTS + i];
        patch->range = found[i].range - self->patch[i];
        patch->azimuth = found[i].azimuth;
        patch->range_rate = self->par.doppler ? found[i].range_rate - self->par.spray_drift * actor->speed : 0;
        patch->strength = self->par.threshold;
        patch->class = 0;
        patch->width = 0;
        patch->valid = self->patch[i] >= 0 && patch->range > 0;
        found[i].strength *= exp(-2 * self->par.spray_depth * amount);
        found[i].valid = found[i].strength >= self->par.threshold;
    }
}

static void ghosts(const objects *self, const view_part *parts, objects_detection found[FOUND], double loss) {
    bool is_radar = self->par.echo_exponent > 0;
    for (int32_t i = 0; i < OBJECTS_ACTORS && is_radar && self->par.ghost_share > 0; ++i) {
        objects_detection *image = &found[OBJECTS_ACTORS + i], *bounce = &found[2 * OBJECTS_ACTORS + i];
        if (!found[i].valid) continue;
        if (self->par.rail != 0) *image = mirrored(self, &self->in.actors[i], parts[i], loss);
        if (self->par.own_reflection > 0) *bounce = bounced(self, &self->in.actors[i], found[i], parts[i].share, loss);
    }
    for (int32_t i = OBJECTS_ACTORS; i < GHOSTS; ++i) {
        if (found[i].valid) found[i].valid = uniform_of(self, i) <= self->par.ghost_share;
    }
}

/* The visible parts of all boxes: of those that hide each other, and of those that hide nothing. */
static void look(const objects *self, const view_box boxes[OBJECTS_ACTORS], view_part parts[OBJECTS_ACTORS]) {
    view_box hiding[OBJECTS_ACTORS], flat[OBJECTS_ACTORS];
    view_part seen[OBJECTS_ACTORS];
    bool is_flat[OBJECTS_ACTORS], any = false;
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) {
        const objects_actor *actor = &self->in.actors[i];
        bool is_low = actor->height > 0 && actor->height <= FLAT;
        is_flat[i] = is_low || actor->clearance > self->par.mount_height;
        hiding[i] = flat[i] = boxes[i];
        if (is_flat[i]) hiding[i].length = -1;
        else flat[i].length = -1;
        any = any || (is_flat[i] && boxes[i].length >= 0);
    }
    double half = 0.5 * self->par.field_of_view;
    view_of(hiding, half, !(self->par.min_visible > 0), parts);
    if (!any) return;
    view_of(flat, half, true, seen);
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) {
        if (is_flat[i]) parts[i] = seen[i];
    }
}

static objects_sample measured(objects *self) {
    view_box boxes[OBJECTS_ACTORS];
    view_part parts[OBJECTS_ACTORS];
    objects_detection found[FOUND];
    double c = cos(direction(self)), s = sin(direction(self)), loss = lost(self);
    double turned_c = cos(self->par.mount_turn), turned_s = sin(self->par.mount_turn);
    double ahead = turned_c * self->par.mount + turned_s * self->par.mount_left; /* of the sensor, along its axes */
    double left = turned_c * self->par.mount_left - turned_s * self->par.mount;
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) {
        const objects_actor *actor = &self->in.actors[i];
        double dx = actor->x - self->in.motion.x, dy = actor->y - self->in.motion.y;
        double turned = actor->heading - direction(self);
        view_box box = {c * dx + s * dy - ahead, c * dy - s * dx - left, cos(turned), sin(turned),
                        0.5 * actor->length, 0.5 * actor->width};
        if (actor->class == 0 || is_on_another_level(actor->above)) box.length = -1;
        boxes[i] = box;
    }
    look(self, boxes, parts);
    for (int32_t i = 0; i < FOUND; ++i) found[i].valid = false;
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) found[i] = detected(self, &self->in.actors[i], parts[i], loss);
    spray_of(self, found);
    ghosts(self, parts, found, loss);
    merge(self, found, FOUND);
    objects_sample sample = {{{false, 0, 0, 0, 0, 0, 0, 0, 0, 0}}};
    int32_t count = 0;
    drift(self);
    for (int32_t i = 0; i < FOUND; ++i) {
        if ((i < OBJECTS_ACTORS && is_lost(self, i)) || !found[i].valid) continue;
        noise drawn = noise_of(self, i < GHOSTS ? i : SPRAY + i);
        if (i < OBJECTS_ACTORS && is_passable(self, &self->in.actors[i], found[i].range, drawn.elevation)) continue;
        disturb(self, &found[i], &drawn);
        int32_t at = count; /* nearest first */
        if (count < OBJECTS_RETURNS) {
            ++count;
        } else if (!(sample.returns[--at].range > found[i].range)) {
            continue;
        }
        for (; at > 0 && sample.returns[at - 1].range > found[i].range; --at) sample.returns[at] = sample.returns[at - 1];
        sample.returns[at] = found[i];
    }
    sensing_skip(&self->random, GHOSTS * DRAWN);
    return sample;
}

static int32_t steps_of(double seconds, int32_t least) {
    int32_t steps = (int32_t)(seconds / OBJECTS_STEP + 0.5);
    return steps > least ? steps : least;
}

static void restart(objects *self) {
    self->random = self->slow = (uint64_t)self->par.seed;
    sensing_skip(&self->slow, AHEAD);
    self->drift.scale = self->drift.azimuth = 0;
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) self->patch[i] = -1;
    self->tick = -1;
    self->told = 0;
}

void objects_step(objects *self) {
    int32_t every = steps_of(self->par.period, 1), late = steps_of(self->par.latency, 0), tick = ++self->tick;
    if (late >= every * OBJECTS_KEPT) late = every * OBJECTS_KEPT - 1;
    if (tick % every == 0) self->made[(tick / every + 1) % OBJECTS_KEPT] = measured(self);
    if (tick < late) return;
    int32_t number = (tick - late) / every + 1;
    if (number != self->told) {
        memcpy(self->out.scan.returns, self->made[number % OBJECTS_KEPT].returns, sizeof self->out.scan.returns);
        self->told = self->out.scan.number = number;
    }
    self->out.scan.age = (tick - (number - 1) * every) * OBJECTS_STEP;
}

void objects_init(objects *self) {
    memset(&self->out, 0, sizeof self->out);
    self->out.scan.mount = self->par.mount;
    self->out.scan.mount_left = self->par.mount_left;
    self->out.scan.mount_turn = self->par.mount_turn;
    self->out.scan.scale = lasting(self->par.scale_bias, self->par.scale_drift, self->par.correlation_time);
    self->out.scan.misalignment = lasting(self->par.azimuth_bias, self->par.azimuth_drift, self->par.correlation_time);
    restart(self);
    objects_step(self);
    restart(self); /* the first step is at time 0, too */
}
