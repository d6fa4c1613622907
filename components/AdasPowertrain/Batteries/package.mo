within AdasPowertrain;
package Batteries "Batteries"
end Batteries;
