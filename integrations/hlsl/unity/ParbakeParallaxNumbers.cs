// Fills a material with the numbers that extract.py wrote: select the material, then Assets > Parbake > Read Numbers.
// Belongs into a folder called Editor.
using System.Globalization;
using System.IO;
using System.Linq;
using UnityEditor;
using UnityEngine;

public static class ParbakeParallaxNumbers
{
    const string Menu = "Assets/Parbake/Read Numbers";

    [MenuItem(Menu, true)]
    static bool IsMaterial() => Selection.activeObject is Material;

    [MenuItem(Menu)]
    static void Read()
    {
        string path = EditorUtility.OpenFilePanel("Numbers of a parallax map", "", "txt");
        if (string.IsNullOrEmpty(path)) return;
        var material = (Material)Selection.activeObject;
        Undo.RecordObject(material, "Read numbers of a parallax map");
        // Of a map without a cutout the text has none: whole from everywhere.
        for (int layer = 0; layer < 3; layer++)
        {
            material.SetVector($"_CutoutScale{layer}", Vector4.zero);
            material.SetVector($"_CutoutOffset{layer}", layer == 0 ? new Vector4(1, 0, 0, 0) : Vector4.zero);
        }
        foreach (string line in File.ReadAllLines(path))
        {
            string[] sides = line.Split('=');
            if (sides.Length != 2) continue;
            string name = "_" + sides[0].Trim();
            if (!material.HasProperty(name))
            {
                Debug.LogWarning($"The material's shader has no {name}: it should be Parbake/Parallax Lit.");
                return;
            }
            float[] numbers = sides[1].Split(',').Select(x => float.Parse(x, CultureInfo.InvariantCulture)).ToArray();
            if (numbers.Length == 4) material.SetVector(name, new Vector4(numbers[0], numbers[1], numbers[2], numbers[3]));
            else material.SetFloat(name, numbers[0]);
        }
        EditorUtility.SetDirty(material);
    }
}
