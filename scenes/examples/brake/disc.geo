// The disc of brake.geo alone.
part = 1;
Include "brake.geo";
