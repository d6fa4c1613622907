within AdasPowertrain;
package Thermal "Bodies that store heat, and a coolant circuit between their heat ports"
end Thermal;
