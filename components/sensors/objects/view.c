#include "view.h"

#include <math.h>

#define PI 3.141592653589793
#define EDGES (4 * OBJECTS_ACTORS + 4)

typedef struct {
    double range;
    int32_t face; /* 0 rear, 1 front, 2 right, 3 left */
} hit;

/* Seen of one face: angle, and from where to where along it. */
typedef struct {
    double angle, from, to, right, left;
} stretch;

/* Where a ray enters the box: through the last of the faces towards it. The sensor is not inside. */
static hit cast(const view_box *box, double azimuth) {
    hit none = {HUGE_VAL, -1}, found = {-HUGE_VAL, -1};
    double c = cos(azimuth), s = sin(azimuth), out = HUGE_VAL;
    double from[2] = {-box->cosine * box->x - box->sine * box->y, box->sine * box->x - box->cosine * box->y};
    double along[2] = {box->cosine * c + box->sine * s, box->cosine * s - box->sine * c};
    double half[2] = {box->length, box->width};
    for (int32_t axis = 0; axis < 2; ++axis) {
        if (along[axis] == 0) {
            if (fabs(from[axis]) > half[axis]) return none;
            continue;
        }
        double middle = -from[axis] / along[axis], reach = half[axis] / fabs(along[axis]);
        if (middle - reach > found.range) {
            found.range = middle - reach;
            found.face = 2 * axis + (along[axis] < 0);
        }
        if (middle + reach < out) out = middle + reach;
    }
    return found.range > 0 && found.range < out ? found : none;
}

/* Where along a face a ray in that direction meets its line, from its middle. */
static double place_on(const view_box *box, int32_t face, double azimuth) {
    double c = cos(azimuth), s = sin(azimuth);
    double from[2] = {-box->cosine * box->x - box->sine * box->y, box->sine * box->x - box->cosine * box->y};
    double along[2] = {box->cosine * c + box->sine * s, box->cosine * s - box->sine * c};
    double half[2] = {box->length, box->width};
    int32_t axis = face / 2, other = 1 - axis;
    double range = ((face & 1 ? half[axis] : -half[axis]) - from[axis]) / along[axis];
    double place = from[other] + range * along[other];
    return place < -half[other] ? -half[other] : place > half[other] ? half[other] : place;
}

static void add(stretch *seen, const view_box *box, int32_t face, double right, double left) {
    double a = place_on(box, face, right), b = place_on(box, face, left);
    double low = fmin(a, b), high = fmax(a, b);
    if (!(seen->angle > 0) || low < seen->from) seen->from = low;
    if (!(seen->angle > 0) || high > seen->to) seen->to = high;
    if (!(seen->angle > 0) || right < seen->right) seen->right = right;
    if (!(seen->angle > 0) || left > seen->left) seen->left = left;
    seen->angle += left - right;
}

static void insert(double edges[EDGES], int32_t *count, double edge) {
    int32_t at = (*count)++;
    for (; at > 0 && edges[at - 1] > edge; --at) edges[at] = edges[at - 1];
    edges[at] = edge;
}

/* Directions between which no box begins or ends and no face does. */
static int32_t edges_of(const view_box boxes[OBJECTS_ACTORS], double half, double edges[EDGES]) {
    int32_t count = 0;
    insert(edges, &count, -PI);
    insert(edges, &count, PI);
    if (half < PI) {
        insert(edges, &count, -half);
        insert(edges, &count, half);
    }
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) {
        const view_box *box = &boxes[i];
        if (box->length < 0) continue;
        double ax = box->cosine * box->length, ay = box->sine * box->length;
        double bx = -box->sine * box->width, by = box->cosine * box->width;
        for (int32_t corner = 0; corner < 4; ++corner) {
            double x = box->x + (corner & 1 ? ax : -ax) + (corner & 2 ? bx : -bx);
            double y = box->y + (corner & 1 ? ay : -ay) + (corner & 2 ? by : -by);
            insert(edges, &count, atan2(y, x));
        }
    }
    return count;
}

static view_part part_of(const view_box *box, const stretch seen[4], double alone) {
    int32_t best = 0;
    for (int32_t face = 1; face < 4; ++face) {
        if (seen[face].angle > seen[best].angle) best = face;
    }
    view_part part = {0, 0, 0, 0, 0};
    if (!(seen[best].angle > 0)) return part;
    double middle = 0.5 * (seen[best].from + seen[best].to), sign = best & 1 ? 1 : -1;
    double along = best < 2 ? sign * box->length : middle, across = best < 2 ? middle : sign * box->width;
    part.x = box->x + box->cosine * along - box->sine * across;
    part.y = box->y + box->sine * along + box->cosine * across;
    part.right = seen[best].right;
    part.left = seen[best].left;
    double all = 0;
    for (int32_t face = 0; face < 4; ++face) all += seen[face].angle;
    part.share = all / alone;
    return part;
}

void view_of(const view_box boxes[OBJECTS_ACTORS], double half, bool through, view_part parts[OBJECTS_ACTORS]) {
    double edges[EDGES], alone[OBJECTS_ACTORS] = {0};
    stretch seen[OBJECTS_ACTORS][4] = {{{0, 0, 0, 0, 0}}};
    int32_t count = edges_of(boxes, half, edges);
    for (int32_t k = 0; k + 1 < count; ++k) {
        double right = edges[k], left = edges[k + 1], azimuth = 0.5 * (right + left);
        if (!(left > right)) continue;
        hit hits[OBJECTS_ACTORS];
        int32_t nearest = -1;
        for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) {
            if (boxes[i].length < 0) continue;
            hits[i] = cast(&boxes[i], azimuth);
            if (hits[i].face < 0) continue;
            alone[i] += left - right;
            if (nearest < 0 || hits[i].range < hits[nearest].range) nearest = i;
            if (through && fabs(azimuth) < half) add(&seen[i][hits[i].face], &boxes[i], hits[i].face, right, left);
        }
        if (nearest < 0 || through || !(fabs(azimuth) < half)) continue;
        add(&seen[nearest][hits[nearest].face], &boxes[nearest], hits[nearest].face, right, left);
    }
    for (int32_t i = 0; i < OBJECTS_ACTORS; ++i) parts[i] = part_of(&boxes[i], seen[i], alone[i]);
}
