#include "car_part.h"

void car_part_init(car_part *self) {
    double front = self->par.front_share * self->par.mass;
    self->out.load = (car_part_axles){front, self->par.mass - front};
    self->out.inertia = (car_part_axles){2 * self->par.wheel_inertia, 2 * self->par.wheel_inertia};
    self->out.drag_area = self->par.drag;
    self->out.power = self->par.draw;
    self->out.tyre = (car_part_tyre){self->par.radius, self->par.grip, self->par.stiffness, self->par.rolling_resistance};
    self->out.gear = (car_part_gear){self->par.ratio, self->par.efficiency, self->par.mass};
    self->out.inverter = (car_part_inverter){self->par.max_current, self->par.standby_power, self->par.loss, self->par.mass};
}

void car_part_step(car_part *self, double h) {
    (void)h;
    car_part_init(self);
}
