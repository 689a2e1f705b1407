// The lower pad of brake.geo alone.
part = 2;
Include "brake.geo";
