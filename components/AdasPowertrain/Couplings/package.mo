within AdasPowertrain;
package Couplings "Clutches and torque converters"
end Couplings;
