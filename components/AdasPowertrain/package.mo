package AdasPowertrain "Powertrains of passenger cars: engines, machines, batteries, couplings, gearboxes and shafts"
end AdasPowertrain;
