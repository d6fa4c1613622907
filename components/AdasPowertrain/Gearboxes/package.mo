within AdasPowertrain;
package Gearboxes "Gears and when to change them"
end Gearboxes;
