within AdasPowertrain;
package Brakes "Friction brakes"
end Brakes;
