#include "objects.h"

#include "../sensing/sensing.h"
#include "view.h"

#include <math.h>

#define LENGTH (OBJECTS_LATENCY + 1)

/* Standard normal numbers and a uniform one, the same for an object whatever else is seen. */
typedef struct {
    double range, azimuth, doppler, uniform;
} noise;

static noise draw(uint64_t *state) {
    double first = sqrt(-2 * log(sensing_uniform(state))), a = 6.283185307179586 * sensing_uniform(state);
    double second = sqrt(-2 * log(sensing_uniform(state))), b = 6.283185307179586 * sensing_uniform(state);
    noise drawn = {first * cos(a), first * sin(a), second * cos(b), sensing_uniform(state)};
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

/* What is lost of light or a wave, 1/m, one way. */
static double lost(const objects *self) {
    return self->par.fog_share * self->in.visibility.fog_extinction +
           sensing_attenuation(self->in.visibility.rain_rate, self->par.rain_loss, self->par.rain_exponent) +
           sensing_attenuation(self->in.visibility.snow_rate, self->par.snow_loss, self->par.snow_exponent);
}

/* Signal to noise of an object at *range*, *share* of which is seen; 0: beyond what a camera sees at all. */
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
    double contrast = self->par.contrast > 0 ? exp(-loss * range) / self->par.contrast : 1;
    return self->par.threshold * contrast * contrast;
}

/* Narrows a part to the beams of the grid that meet it; false: none does. */
static bool beams_meet(const objects *self, view_part *part) {
    double spacing = self->par.beam_spacing;
    if (!(spacing > 0)) return true;
    part->right = ceil(part->right / spacing) * spacing;
    part->left = floor(part->left / spacing) * spacing;
    return part->right <= part->left;
}

static bool layers_meet(const objects *self, double height, double range) {
    if (!(self->par.layer_spacing > 0)) return true;
    for (int32_t i = 0; i < self->par.layers; ++i) {
        double above = self->par.mount_height + range * tan((i - 0.5 * (self->par.layers - 1)) * self->par.layer_spacing);
        if (above >= 0 && above <= height) return true;
    }
    return false;
}

/* What one object gives, without noise; valid if it is detected. */
static objects_detection detected(const objects *self, const objects_actor *actor, view_part part, double loss) {
    objects_detection told = {false, 0, 0, 0, 0, 0, 0};
    if (!(part.share > 0) || part.share < self->par.min_visible || !beams_meet(self, &part)) return told;
    double range = sqrt(part.x * part.x + part.y * part.y);
    if (!(range > 0) || !layers_meet(self, actor->height, range)) return told;
    told.strength = strength(self, reflection(self, actor->class), part.share, range, loss);
    told.valid = told.strength > 0 && told.strength >= self->par.threshold;
    told.range = range;
    told.azimuth = atan2(part.y, part.x);
    if (self->par.doppler) {
        double turned = actor->heading - self->in.motion.heading, c = cos(turned), s = sin(turned);
        double vx = actor->speed * c - actor->lateral_speed * s - self->in.motion.speed;
        double vy = actor->speed * s + actor->lateral_speed * c - self->in.motion.lateral_speed -
                    self->in.motion.yaw_rate * self->par.mount;
        told.range_rate = (vx * part.x + vy * part.y) / range;
    }
    if (self->par.tells_class) told.class = actor->class;
    if (self->par.tells_width) told.width = 2 * tan(0.5 * (part.left - part.right)); /* at a range of 1 m */
    return told;
}

static bool one_cell(const objects *self, const objects_detection *a, const objects_detection *b) {
    return fabs(a->range - b->range) < self->par.range_cell && fabs(a->azimuth - b->azimuth) < self->par.azimuth_cell &&
           (!self->par.doppler || fabs(a->range_rate - b->range_rate) < self->par.doppler_cell);
}

/* Strongest first, each takes in the weaker ones of its cell. */
static void merge(const objects *self, objects_detection found[OBJECTS_ACTORS]) {
    bool done[OBJECTS_ACTORS] = {false};
    for (;;) {
        int32_t top = -1;
        for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) {
            if (found[i].valid && !done[i] && (top < 0 || found[i].strength > found[top].strength)) top = i;
        }
        if (top < 0) return;
        objects_detection first = found[top], *sum = &found[top];
        done[top] = true;
        for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) {
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

static void disturb(const objects *self, objects_detection *told, const noise *drawn) {
    double sigma = sqrt(self->par.range_noise * self->par.range_noise +
                        self->par.relative_noise * self->par.relative_noise * told->range * told->range);
    told->range = fmax(told->range + sigma * drawn->range, 0);
    told->azimuth += self->par.azimuth_noise * drawn->azimuth;
    if (self->par.doppler) told->range_rate += self->par.doppler_noise * drawn->doppler;
    told->width *= told->range;
}

static objects_sample measured(objects *self) {
    view_box boxes[OBJECTS_ACTORS];
    view_part parts[OBJECTS_ACTORS];
    objects_detection found[OBJECTS_ACTORS];
    noise drawn[OBJECTS_ACTORS];
    double c = cos(self->in.motion.heading), s = sin(self->in.motion.heading);
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) {
        const objects_actor *actor = &self->in.actors[i];
        double dx = actor->x - self->in.motion.x, dy = actor->y - self->in.motion.y;
        double turned = actor->heading - self->in.motion.heading;
        view_box box = {c * dx + s * dy - self->par.mount, c * dy - s * dx, cos(turned), sin(turned),
                        0.5 * actor->length, 0.5 * actor->width};
        if (actor->class == 0) box.length = -1;
        boxes[i] = box;
        drawn[i] = draw(&self->random);
    }
    view_of(boxes, 0.5 * self->par.field_of_view, !(self->par.min_visible > 0), parts);
    double loss = lost(self);
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) found[i] = detected(self, &self->in.actors[i], parts[i], loss);
    merge(self, found);
    objects_sample sample = {{{false, 0, 0, 0, 0, 0, 0}}};
    int32_t count = 0;
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) {
        if (!found[i].valid || drawn[i].uniform <= self->par.dropout) continue;
        disturb(self, &found[i], &drawn[i]);
        int32_t at = count++; /* nearest first */
        for (; at > 0 && sample.detections[at - 1].range > found[i].range; --at) {
            sample.detections[at] = sample.detections[at - 1];
        }
        sample.detections[at] = found[i];
    }
    return sample;
}

void objects_init(objects *self) {
    self->random = (uint64_t)self->par.seed;
    self->newest = 0;
    self->out = measured(self);
    for (int32_t i = 0; i < LENGTH; ++i) self->samples[i] = self->out;
}

void objects_step(objects *self) {
    self->newest = (self->newest + 1) % LENGTH;
    self->samples[self->newest] = measured(self);
    int32_t latency = self->par.latency;
    if (latency < 0) latency = 0;
    if (latency > OBJECTS_LATENCY) latency = OBJECTS_LATENCY;
    self->out = self->samples[(self->newest - latency + LENGTH) % LENGTH];
}
