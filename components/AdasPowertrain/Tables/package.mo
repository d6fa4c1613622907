within AdasPowertrain;
package Tables "Interpolation in one and two dimensions"
end Tables;
