within AdasPowertrain;
package Parts "Parts that become one FMU each, coupled by signals at the communication step"
end Parts;
