/* Intelligent Driver Model as cruise control (Treiber, Hennecke, Helbing: Phys. Rev. E 62, 1805, 2000). */
#ifndef IDM_ACC_H
#define IDM_ACC_H

#include "../acc/acc.h"

typedef struct {
    double comfortable_deceleration;
    int32_t gap_setting;
    double standstill_gap;
    double max_acceleration, max_deceleration;
    double nominal_mass, wheel_radius, drag_area, rolling_resistance;
} idm_acc_par;

typedef struct {
    acc_in in;
    acc_out out;
    idm_acc_par par;
} idm_acc;

void idm_acc_init(idm_acc *self);
void idm_acc_step(idm_acc *self);

#endif
