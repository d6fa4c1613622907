#include "car_model.h"

#include <math.h>

#define GRAVITY 9.81 /* m/s2 */
#define SIZE 5       /* the state and the steering */

double car_rear(const car_model *car) {
    return car->wheelbase * car->front_load_share;
}

static double front_stiffness(const car_model *car) {
    return car->front_stiffness * car->mass * GRAVITY * car->front_load_share;
}

static double rear_stiffness(const car_model *car) {
    return car->rear_stiffness * car->mass * GRAVITY * (1 - car->front_load_share);
}

static void multiply(const double a[SIZE][SIZE], const double b[SIZE][SIZE], double product[SIZE][SIZE]) {
    for (int i = 0; i < SIZE; ++i) {
        for (int j = 0; j < SIZE; ++j) {
            double sum = 0;
            for (int k = 0; k < SIZE; ++k) sum += a[i][k] * b[k][j];
            product[i][j] = sum;
        }
    }
}

/* exp(m): its series for m / 2^n, whose largest row sum is below 1/2, then n times the square. */
static void exponential(double m[SIZE][SIZE], double result[SIZE][SIZE]) {
    double largest = 0, term[SIZE][SIZE], next[SIZE][SIZE];
    for (int i = 0; i < SIZE; ++i) {
        double sum = 0;
        for (int j = 0; j < SIZE; ++j) sum += fabs(m[i][j]);
        largest = fmax(largest, sum);
    }
    int squarings = 0;
    for (; largest >= 0.5 && squarings < 60; ++squarings) largest *= 0.5;
    for (int i = 0; i < SIZE; ++i) {
        for (int j = 0; j < SIZE; ++j) {
            m[i][j] = ldexp(m[i][j], -squarings);
            result[i][j] = term[i][j] = i == j ? 1 : 0;
        }
    }
    for (int n = 1; n <= 15; ++n) { /* 0.5^15 / 15! < 1e-16 */
        multiply((const double(*)[SIZE])term, (const double(*)[SIZE])m, next);
        for (int i = 0; i < SIZE; ++i) {
            for (int j = 0; j < SIZE; ++j) result[i][j] += term[i][j] = next[i][j] / n;
        }
    }
    for (int n = 0; n < squarings; ++n) {
        multiply((const double(*)[SIZE])result, (const double(*)[SIZE])result, next);
        for (int i = 0; i < SIZE; ++i) {
            for (int j = 0; j < SIZE; ++j) result[i][j] = next[i][j];
        }
    }
}

car_motion car_motion_over(const car_model *car, double speed, double time) {
    double cf = front_stiffness(car), cr = rear_stiffness(car);
    double b = car_rear(car), a = car->wheelbase - b, m = car->mass, inertia = car->yaw_inertia;
    double sum = cf + cr, turning = a * cf - b * cr, damping = a * a * cf + b * b * cr;
    double rates[SIZE][SIZE] = {
        {0, 1, 0, 0, 0},
        {0, -sum / (m * speed), sum / m, -turning / (m * speed), cf / m},
        {0, 0, 0, 1, 0},
        {0, -turning / (inertia * speed), turning / inertia, -damping / (inertia * speed), a * cf / inertia},
        {0, 0, 0, 0, 0},
    };
    double over[SIZE][SIZE];
    for (int i = 0; i < SIZE; ++i) {
        for (int j = 0; j < SIZE; ++j) rates[i][j] *= time;
    }
    exponential(rates, over);
    car_motion motion;
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) motion.transition[i][j] = over[i][j];
        motion.steering[i] = over[i][4];
    }
    return motion;
}

car_balance car_balance_on(const car_model *car, double speed, double curvature, double bank) {
    double cf = front_stiffness(car), cr = rear_stiffness(car), length = car->wheelbase;
    double b = car_rear(car), a = length - b;
    double sideways = car->mass * (speed * speed * curvature + GRAVITY * bank); /* required tyre force */
    car_balance balance = {
        -b * curvature + sideways * a / (length * cr),
        length * curvature + sideways * (b / cf - a / cr) / length,
    };
    return balance;
}
