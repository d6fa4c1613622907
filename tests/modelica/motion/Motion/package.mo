package Motion "Classes whose names the front-end mixes up"
end Motion;
