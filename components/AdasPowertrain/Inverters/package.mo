within AdasPowertrain;
package Inverters "Inverters"
end Inverters;
