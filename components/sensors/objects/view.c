#include "view.h"

#include <math.h>

#define PI 3.141592653589793
#define EDGES (4 * OBJECTS_ACTORS + 4) /* of boxes, of the circle and of the field of view */
#define LEAST_ACROSS 1e-3 /* a width of 0 means: unknown */

typedef struct {
    double range;
    int32_t face; /* 0 rear, 1 front, 2 right, 3 left */
} hit;

/* Seen of one face: angle, and its two ends along it. */
typedef struct {
    double angle, from, to, right, left;
} stretch;

/* A box and the sensor's rays: the sensor in the axes of the box, and the directions between which the box is. */
typedef struct {
    double from[2], half[2];
    double right, width; /* rad; width 0: nothing of it is seen */
    double inside;       /* rad that are seen in the field of view */
} target;

/* A direction, seen from a box. */
typedef struct {
    double along[2];
} ray;

static ray ray_to(const view_box *box, double c, double s) {
    ray one = {{box->cosine * c + box->sine * s, box->cosine * s - box->sine * c}};
    return one;
}

static double wrapped(double angle) { return angle > PI ? angle - 2 * PI : angle <= -PI ? angle + 2 * PI : angle; }

static bool is_towards(const target *box, double azimuth) {
    double left = azimuth - box->right;
    return left > 0 ? left < box->width : left + 2 * PI < box->width;
}

/* Where a ray enters the box: through the last of the faces towards it. The sensor is outside. */
static hit cast(const target *box, ray one) {
    hit none = {HUGE_VAL, -1}, found = {-HUGE_VAL, -1};
    double out = HUGE_VAL;
    for (int32_t axis = 0; axis < 2; ++axis) {
        if (one.along[axis] == 0) {
            if (fabs(box->from[axis]) > box->half[axis]) return none;
            continue;
        }
        double inverse = 1 / one.along[axis], middle = -box->from[axis] * inverse, reach = box->half[axis] * fabs(inverse);
        if (middle - reach > found.range) {
            found.range = middle - reach;
            found.face = 2 * axis + (one.along[axis] < 0);
        }
        if (middle + reach < out) out = middle + reach;
    }
    return found.range > 0 && found.range < out ? found : none;
}

/* Where along a face a ray meets its line, from its middle. */
static double place_on(const target *box, int32_t face, ray one) {
    int32_t axis = face / 2, other = 1 - axis;
    double range = ((face & 1 ? box->half[axis] : -box->half[axis]) - box->from[axis]) / one.along[axis];
    double place = box->from[other] + range * one.along[other];
    return place < -box->half[other] ? -box->half[other] : place > box->half[other] ? box->half[other] : place;
}

/* Directions, with their cosines and sines. */
typedef struct {
    double azimuth, cosine, sine;
} edge;

static void add(stretch *seen, const view_box *box, const target *rays, int32_t face, const edge *right, const edge *left) {
    double a = place_on(rays, face, ray_to(box, right->cosine, right->sine));
    double b = place_on(rays, face, ray_to(box, left->cosine, left->sine));
    double low = a < b ? a : b, high = a < b ? b : a;
    if (!(seen->angle > 0) || low < seen->from) seen->from = low;
    if (!(seen->angle > 0) || high > seen->to) seen->to = high;
    double behind = left->azimuth <= rays->right ? 2 * PI : 0; /* past the direction backwards */
    if (!(seen->angle > 0) || right->azimuth + behind < seen->right) seen->right = right->azimuth + behind;
    if (!(seen->angle > 0) || left->azimuth + behind > seen->left) seen->left = left->azimuth + behind;
    seen->angle += left->azimuth - right->azimuth;
}

static void insert(edge edges[EDGES], int32_t *count, edge one) {
    int32_t at = (*count)++;
    for (; at > 0 && edges[at - 1].azimuth > one.azimuth; --at) edges[at] = edges[at - 1];
    edges[at] = one;
}

/* All directions at which a box or a face begins or ends, with those of the edges of the field of view; and the places
 * of the boxes. */
static int32_t edges_of(const view_box boxes[OBJECTS_ACTORS], double half, edge edges[EDGES], target targets[OBJECTS_ACTORS]) {
    edge first = {-PI, -1, 0}, last = {PI, -1, 0};
    edge right_end = {-half, cos(half), -sin(half)}, left_end = {half, cos(half), sin(half)};
    int32_t count = 0;
    insert(edges, &count, first);
    insert(edges, &count, last);
    if (half < PI) {
        insert(edges, &count, right_end);
        insert(edges, &count, left_end);
    }
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) {
        const view_box *box = &boxes[i];
        target *rays = &targets[i];
        rays->right = rays->width = rays->inside = 0;
        if (box->length < 0) continue;
        rays->from[0] = -box->cosine * box->x - box->sine * box->y;
        rays->from[1] = box->sine * box->x - box->cosine * box->y;
        rays->half[0] = box->length;
        rays->half[1] = box->width;
        if (fabs(rays->from[0]) <= box->length && fabs(rays->from[1]) <= box->width) continue; /* around the sensor */
        double ax = box->cosine * box->length, ay = box->sine * box->length;
        double bx = -box->sine * box->width, by = box->cosine * box->width;
        double begin = 0, right = 0, left = 0;
        for (int32_t corner = 0; corner < 4; ++corner) {
            double x = box->x + (corner & 1 ? ax : -ax) + (corner & 2 ? bx : -bx);
            double y = box->y + (corner & 1 ? ay : -ay) + (corner & 2 ? by : -by);
            double azimuth = atan2(y, x), range = sqrt(x * x + y * y);
            if (corner == 0) begin = azimuth;
            double turn = wrapped(azimuth - begin);
            if (turn < right) right = turn;
            if (turn > left) left = turn;
            edge one = {azimuth, x / range, y / range};
            insert(edges, &count, one);
        }
        rays->right = wrapped(begin + right);
        rays->width = left - right;
    }
    return count;
}

static view_part part_of(const view_box *box, const stretch seen[4], const target *rays) {
    int32_t best = 0;
    for (int32_t face = 1; face < 4; ++face) {
        if (seen[face].angle > seen[best].angle) best = face;
    }
    view_part part = {0, 0, 0, 0, 0, 0};
    if (!(seen[best].angle > 0)) return part;
    double middle = 0.5 * (seen[best].from + seen[best].to), sign = best & 1 ? 1 : -1;
    double along = best < 2 ? sign * box->length : middle, across = best < 2 ? middle : sign * box->width;
    part.x = box->x + box->cosine * along - box->sine * across;
    part.y = box->y + box->sine * along + box->cosine * across;
    part.right = seen[best].right;
    part.left = seen[best].left;
    part.across = fmax(fabs(best < 2 ? box->cosine : box->sine), LEAST_ACROSS);
    part.share = rays->inside / rays->width;
    return part;
}

void view_of(const view_box boxes[OBJECTS_ACTORS], double half, bool through, view_part parts[OBJECTS_ACTORS]) {
    edge edges[EDGES];
    target targets[OBJECTS_ACTORS];
    stretch seen[OBJECTS_ACTORS][4] = {{{0, 0, 0, 0, 0}}};
    int32_t count = edges_of(boxes, half, edges, targets);
    for (int32_t k = 0; k + 1 < count; ++k) {
        const edge *right = &edges[k], *left = &edges[k + 1];
        double azimuth = 0.5 * (right->azimuth + left->azimuth), c = 0, s = 0;
        if (!(left->azimuth > right->azimuth)) continue;
        hit best = {HUGE_VAL, -1};
        int32_t nearest = -1;
        for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) {
            if (!is_towards(&targets[i], azimuth)) continue;
            if (c == 0 && s == 0) {
                c = cos(azimuth);
                s = sin(azimuth);
            }
            hit found = cast(&targets[i], ray_to(&boxes[i], c, s));
            if (found.face < 0) continue;
            if (through && fabs(azimuth) < half) targets[i].inside += left->azimuth - right->azimuth;
            if (through) add(&seen[i][found.face], &boxes[i], &targets[i], found.face, right, left);
            if (!(found.range < best.range)) continue;
            best = found;
            nearest = i;
        }
        if (nearest < 0 || through) continue;
        if (fabs(azimuth) < half) targets[nearest].inside += left->azimuth - right->azimuth;
        add(&seen[nearest][best.face], &boxes[nearest], &targets[nearest], best.face, right, left);
    }
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) parts[i] = part_of(&boxes[i], seen[i], &targets[i]);
}
