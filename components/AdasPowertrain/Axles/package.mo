within AdasPowertrain;
package Axles "Driven axles with fixed reduction"
end Axles;
