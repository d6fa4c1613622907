within AdasPowertrain;
package Vehicles "Records of data; every record names its source"
end Vehicles;
